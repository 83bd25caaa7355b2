#include "controller_interface.h"

namespace knee_robot::nodes {

ControllerInterface::ControllerInterface(const Parts& parts)
    : references_(parts.references),
      action_(actions_.node, parts.system, parts.references, parts.recordings),
      gains_(commands_.node, parts.system),
      feedforward_(commands_.node, parts.system),
      topics_(topics_lane_.node, parts.system, parts.robot, parts.rate_hz),
      timing_(topics_lane_.node, parts.system),
      diagnostics_(topics_lane_.node, parts.system, parts.robot, parts.guardian),
      components_(commands_.node, parts.system),
      services_(commands_.node, stops_.node, parts.system, parts.references, parts.patients, parts.recordings),
      running_{{&commands_, &stops_, &actions_, &topics_lane_}} {
  parts.references.advertise(topics_lane_.node);
  for (Lane* lane : running_.lanes)
    lane->start();
}

}  // namespace knee_robot::nodes
