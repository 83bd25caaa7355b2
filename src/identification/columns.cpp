#include "knee_robot/identification/columns.h"

#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/identification/motion_model.h"

namespace knee_robot::identification {

std::string rigidUnit(int column) {
  const int place = column % dynamics::kLinkParameters;  // Ixx Ixy Ixz Iyy Iyz Izz mx my mz m
  if (place == dynamics::kLinkParameters - 1) return "kg";
  return place < 6 ? "kg m^2" : "kg m";
}

const char* unitOf(ColumnRole role, bool revolute) {
  switch (role) {
    case ColumnRole::Viscous:
      return revolute ? "N m s/rad" : "N s/m";
    case ColumnRole::Rotor:
      return revolute ? "kg m^2" : "kg";
    default:
      return revolute ? "N m" : "N";
  }
}

std::vector<Column> columnsOf(const mechanism::Robot& robot, bool joint_friction) {
  return motionModelOf(robot)->columns(joint_friction);
}

}  // namespace knee_robot::identification
