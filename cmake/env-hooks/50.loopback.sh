# Sourced by setup.bash: nothing of ROS is exposed to the network unless ROS_IP or ROS_HOSTNAME asks for it (docs/network.md).
if [ -z "${ROS_IP:-}" ] && [ -z "${ROS_HOSTNAME:-}" ]; then
  export ROS_IP=127.0.0.1
fi
