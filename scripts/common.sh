# Sourced by the scripts of this folder: root of the repository, system python first in PATH, one way to speak.
set -euo pipefail
KNEE_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
KNEE_BUILD=${KNEE_BUILD:-$KNEE_ROOT/build}
# One job a processor, and 2 GB of memory for each: so much the largest compilation takes.
KNEE_JOBS=${KNEE_JOBS:-$(awk -v cores="$(nproc)" '/^MemTotal/ { room = int($2 / 2e6); print room < 1 ? 1 : room < cores ? room : cores }' /proc/meminfo)}
# ROS's own programs are written for Debian's python3: a pyenv or conda one that comes first in PATH breaks them.
export PATH="/usr/bin:/bin:$PATH"
unset PYTHONHOME PYTHONPATH

say() { printf '\n== %s\n' "$*"; }
fail() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 2
}

# Environment of the built package. setup.bash reads variables that may be unset.
source_ros() {
  [[ -f $KNEE_BUILD/devel/setup.bash ]] || fail "nothing is built yet; run scripts/build first"
  set +u
  # shellcheck disable=SC1091
  source "$KNEE_BUILD/devel/setup.bash"
  set -u
  export ROS_IP=127.0.0.1
  unset ROS_HOSTNAME
}

# A TCP port of the loopback interface that is free now, for a roscore of one's own.
free_port() {
  /usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}
