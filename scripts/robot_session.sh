# Sourced by scripts that run the simulated robot under ROS: a master of their own, rviz on a screen of their own, services that
# must succeed, and an end in any case. Needs common.sh and source_ros first.

# start_robot FOLDER LAUNCH_ARGUMENT...: roslaunch simulation.launch with its logs in FOLDER. Robot, servo cycle and guardian share the first
# processor: on a virtual machine that pauses the processors one at a time, each would call the others dead.
start_robot() {
  local folder=$1 cpu
  cpu=$(sed -n 's/^Cpus_allowed_list:[[:space:]]*\([0-9]*\).*/\1/p' /proc/self/status)
  shift
  mkdir -p "$folder"
  export ROS_HOME=$folder/ros ROS_LOG_DIR=$folder/ros/log
  local port
  port=$(free_port)
  export ROS_MASTER_URI=http://127.0.0.1:$port
  roslaunch --port "$port" knee_robot simulation.launch "shm:=/knee_robot_$port" "cpu:=$cpu" empty:=true "$@" > "$folder/roslaunch.log" 2>&1 &
  ROBOT_PID=$!
  trap stop_robot EXIT
  local tries
  for ((tries = 0; tries < 120; tries++)); do
    kill -0 "$ROBOT_PID" 2> /dev/null || break
    if timeout 20 rosservice call /controller/get_state > /dev/null 2>&1; then return 0; fi
    sleep 0.5
  done
  tail -n 20 "$folder/roslaunch.log" >&2
  fail "the robot did not come up (log: $folder/roslaunch.log)"
}

# start_screen: a display without a monitor, for rviz.
start_screen() {
  local number
  for number in {97..140}; do [[ -e /tmp/.X$number-lock || -e /tmp/.X11-unix/X$number ]] || break; done
  Xvfb ":$number" -screen 0 1280x800x24 +extension GLX > /dev/null 2>&1 &
  SCREEN_PID=$!
  trap stop_robot EXIT
  export DISPLAY=:$number LIBGL_ALWAYS_SOFTWARE=1 QT_X11_NO_MITSHM=1
  export XDG_RUNTIME_DIR=${XDG_RUNTIME_DIR:-$(mktemp -d)}
  sleep 1
}

# photograph FILE.png: the screen as soon as rviz has drawn the robot; 64 colours, which is plenty for it and a fifth of the size.
# Waits at most KNEE_PICTURE_WAIT seconds (30). Status 1, with a sentence, when there is nothing but background until then: no file.
photograph() {
  local tries colours=0 light=0 picture
  picture=$(mktemp --suffix=.png)
  for ((tries = 0; tries < ${KNEE_PICTURE_WAIT:-30}; tries++)); do
    import -window root "$picture" 2> /dev/null || true
    # The middle of the window. No window, or rviz's splash: dark. Background and grid: light, a handful of colours. A lit robot: hundreds.
    read -r colours light < <(convert "$picture" -gravity center -crop 40%x40%+0+0 +repage -format '%k %[fx:int(100*mean)]\n' info: 2> /dev/null) ||
      true
    if [[ ${colours:-0} -gt 100 && ${light:-0} -gt 50 ]]; then
      convert "$picture" +dither -colors 64 -strip "PNG8:$1"
      rm -f "$picture"
      echo "   $1"
      return 0
    fi
    sleep 1
  done
  rm -f "$picture"
  echo "no picture $1: rviz has drawn nothing in ${KNEE_PICTURE_WAIT:-30} s ($colours colours on the screen); did it start?" >&2
  return 1
}

stop_robot() {
  trap - EXIT
  if [[ -n ${ROBOT_PID:-} ]]; then
    kill -INT "$ROBOT_PID" 2> /dev/null || true
    wait "$ROBOT_PID" 2> /dev/null || true
    ROBOT_PID=
  fi
  if [[ -n ${SCREEN_PID:-} ]]; then
    kill "$SCREEN_PID" 2> /dev/null || true
    SCREEN_PID=
  fi
}

# The answer's sentence in one piece: rosservice breaks long lines.
message_of() { /usr/bin/python3 -c 'import sys, yaml; print(yaml.safe_load(sys.stdin)["message"])'; }

# command_robot SERVICE [REQUEST]: calls a service of the controller, prints its answer, ends the script when it refuses.
command_robot() {
  local answer
  answer=$(timeout 60 rosservice call "/controller/$1" "${2:-{\}}") || fail "service $1 did not answer"
  printf '   %-16s %s\n' "$1" "$(message_of <<< "$answer")"
  grep -qx 'success: True' <<< "$answer" || fail "the robot refused $1"
}

robot_state() { timeout 20 rosservice call /controller/get_state | sed -n 's/^  state: *//p' | tr -d '"'; }

# wait_for_state STATE SECONDS
wait_for_state() {
  local end=$((SECONDS + $2)) state=
  while ((SECONDS < end)); do
    state=$(robot_state)
    [[ $state != "$1" ]] || return 0
    if [[ $state == faulted ]]; then
      timeout 20 rosservice call /controller/get_state >&2
      fail "the robot is in state faulted, see the cause above"
    fi
    sleep 0.5
  done
  fail "the robot is still in state $state after $2 s, not in $1"
}
