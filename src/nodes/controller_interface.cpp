#include "controller_interface.h"

namespace knee_robot::nodes {

ControllerInterface::ControllerInterface(const Parts& parts)
    : references_(parts.references),
      commands_(parts.system, 3),
      stops_(parts.system, 4),
      actions_(parts.system, 2),
      topics_lane_(parts.system, 1),
      onlookers_(parts.system, 1),
      action_(actions_.node, parts.system, parts.references, parts.recordings, parts.log),
      gains_(commands_.node, parts.system, parts.log),
      feedforward_(commands_.node, parts.system, parts.log),
      topics_(topics_lane_.node, parts.system, parts.robot, parts.rate_hz),
      timing_(topics_lane_.node, parts.system),
      diagnostics_(topics_lane_.node, parts.system, parts.robot, parts.guardian),
      components_(commands_.node, parts.system, parts.log),
      events_(onlookers_.node, parts.system, parts.log),
      ports_(onlookers_.node, parts.system, parts.log),
      services_(commands_.node, stops_.node, parts.system, parts.references, parts.patients, parts.recordings,
                parts.log),
      running_{{&commands_, &stops_, &actions_, &topics_lane_, &onlookers_}} {
  parts.references.advertise(topics_lane_.node);
  for (Lane* lane : running_.lanes)
    lane->start();
}

}  // namespace knee_robot::nodes
