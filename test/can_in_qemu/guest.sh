#!/bin/bash
# Runs in the guest (scripts/test_can_in_qemu): real SocketCAN. The host's files are there read-only; /run can be written.
# Prints `ok NAME` and `not ok NAME: why`; nothing else that begins so.
# Usage: guest.sh REPOSITORY BUILD PYTHON
set -u
root=$1 programs=$2/devel/lib/knee_robot python=$3
work=/run/knee
mkdir -p $work /run/lock  # where every Debian has its locks
cd $work || exit 1
export PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$root/test/can_in_qemu
tests=$root/test/can_in_qemu
objects=$root/config/hardware/can_objects.yaml
robot=$root/config/robots/A.yaml

say() { echo "# $(cut -d' ' -f1 /proc/uptime) $*"; }
# check NAME COMMAND...: its output is shown when it fails
check() {
  local name=$1
  shift
  if "$@" >check.log 2>&1; then echo "ok $name"; else
    echo "not ok $name: status $?, $(tail -n 1 check.log)"
    sed 's/^/#   /' check.log | tail -n 30
  fi
}
refuses_with() {  # refuses_with TEXT COMMAND...: exit status 3 and this text
  local text=$1 status=0
  shift
  "$@" >refusal.log 2>&1 || status=$?
  cat refusal.log
  [[ $status -eq 3 ]] && grep -q "$text" refusal.log
}
# An emulated machine is slow: 50 Hz, patient limits.
sed -e 's/period_s: .*/period_s: 0.02/' -e 's/heartbeat_s: .*/heartbeat_s: 0.4/' -e 's/missed_feedback: .*/missed_feedback: 20/' \
    -e 's/drive_enable_delay_s: .*/drive_enable_delay_s: 1.0/' "$root/config/hardware/can_simulated.yaml" >hardware.yaml
simulate() {  # simulate BUS: in the background
  "$programs/cia402_simulator" --robot "$robot" --simulation "$root/config/simulation/A.yaml" --hardware hardware.yaml \
    --objects "$objects" --bus "$1" --shm /knee_qemu "${@:2}" >simulator.log 2>&1 &
  simulator=$!
  for _ in $(seq 200); do grep -q ready simulator.log && return 0; sleep 0.05; done
  cat simulator.log
  return 1
}
finish() { kill "$1" 2>/dev/null; wait "$1" 2>/dev/null; }
drives() { "$programs/check_drives" --hardware hardware.yaml --robot "$robot" "$@"; }

# Everything is read once before anything is timed: time in the guest goes on while it waits for the host's files.
for program in check_drives cia402_simulator; do "$programs/$program" --help; done >/dev/null
"$programs/hardware_tests" --file=can_socket_test --gtest_list_tests >/dev/null
"$python" -c "import canopen, can.interfaces.socketcan, dictionary; dictionary.load('$objects')"
candump --help >/dev/null 2>&1
say "$(uname -rv)"
ip link add dev vcan0 type vcan && ip link set vcan0 up
check "socket tests on vcan0" env KNEE_CAN_INTERFACE=vcan0 TEST_TMPDIR=$work "$programs/hardware_tests" --file=can_socket_test
say "our controller, our drives, vcan0"
simulate vcan0
candump -L vcan0 >dump.log & dump=$!
sleep 0.3
check "our controller enables our drives on vcan0" drives --bus vcan0 --seconds 1.5 --enable
finish $dump
"$python" "$tests/check_candump.py" dump.log "our drives"
say "the interface goes down in the middle"
(sleep 2; ip link set vcan0 down) & breaker=$!
check "interface down is the cause that is told" refuses_with "the CAN interface is down or gone" drives --bus vcan0 --seconds 30
wait $breaker
ip link set vcan0 up
finish $simulator
say "the drives go away in the middle"
simulate vcan0
(sleep 2; kill $simulator) & breaker=$!
check "lost drives are the cause that is told" refuses_with "the drive sends no feedback\|heartbeat" drives --bus vcan0 --seconds 30
wait $breaker
check "no drive answers: told by node" refuses_with "node 1.*no answer" drives --bus vcan0
finish $simulator

say "another master (canopen), our drives"
simulate vcan0
"$python" "$tests/peer_master.py" vcan0 "$objects" || true
finish $simulator

say "our controller, other drives (canopen)"
"$python" "$tests/peer_drives.py" vcan0 "$objects" >peer.log 2>&1 & peer=$!
for _ in $(seq 600); do grep -q ready peer.log && break; sleep 0.05; done
candump -L vcan0 >dump.log & dump=$!
check "our controller enables canopen's drives on vcan0" drives --bus vcan0 --seconds 1.5 --enable
finish $dump
finish $peer
grep '^node' peer.log | sed 's/^/# /'
check "canopen's drives were enabled step by step, without torque before" \
  test "$(grep -c 'disabled > ready > on > enabled > ready.*torques before enabled: 0' peer.log)" -eq 4
"$python" "$tests/check_candump.py" dump.log "canopen's drives"

say "two controllers on an emulated bus: our drives on can1, our controller on can0"
for interface in can0 can1; do
  ip link set $interface type can bitrate 1000000 restart-ms 100 && ip link set $interface up
done
simulate can1
candump -L can1 >dump.log & dump=$!
check "our controller enables our drives across the emulated bus" drives --bus can0 --seconds 1.5 --enable
finish $dump
"$python" "$tests/check_candump.py" dump.log "emulated bus"
finish $simulator
say "done"
exit 0
