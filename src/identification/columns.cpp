#include "knee_robot/identification/columns.h"

#include "knee_robot/dynamics/model.h"
#include "knee_robot/dynamics/parameters.h"

namespace knee_robot {
namespace {

std::string rigidUnit(int column) {
  const int place = column % kLinkParameters;  // Ixx Ixy Ixz Iyy Iyz Izz mx my mz m
  if (place == kLinkParameters - 1) return "kg";
  return place < 6 ? "kg m^2" : "kg m";
}

const char* unitOf(ColumnRole role) {
  switch (role) {
    case ColumnRole::Viscous:
      return "N s/m";
    case ColumnRole::Rotor:
      return "kg";
    default:
      return "N";
  }
}

}  // namespace

std::vector<Column> columnsOf(const Robot& robot, bool joint_friction) {
  std::vector<Column> columns;
  if (robot.kind == MechanismKind::Axes) {
    const std::vector<std::string> names = axisParameterNames(robot.axes());
    const ColumnRole roles[] = {ColumnRole::Viscous, ColumnRole::Coulomb, ColumnRole::Rotor, ColumnRole::Offset};
    for (std::size_t i = 0; i < names.size(); ++i) {
      columns.push_back({names[i], unitOf(roles[i % 4]), roles[i % 4], static_cast<int>(i / 4)});
    }
    return columns;
  }
  const std::vector<std::string>& names = extendedParameterNames();
  for (int i = 0; i < kInertialParameters; ++i) {
    columns.push_back({names[static_cast<std::size_t>(i)], rigidUnit(i), ColumnRole::Rigid, -1});
  }
  for (int i = 0; joint_friction && i < extended::kPassiveFrictionCount; ++i) {
    const bool viscous = i % 2 == 0;
    columns.push_back({names[static_cast<std::size_t>(extended::kPassiveFriction + i)], viscous ? "N m s/rad" : "N m",
                       ColumnRole::JointFriction, -1});
  }
  const std::pair<ColumnRole, int> blocks[] = {{ColumnRole::Viscous, extended::kViscous},
                                               {ColumnRole::Coulomb, extended::kCoulomb},
                                               {ColumnRole::Rotor, extended::kRotor},
                                               {ColumnRole::Offset, extended::kOffset}};
  for (const auto& [role, first] : blocks) {
    for (int leg = 0; leg < kLegs; ++leg) {
      columns.push_back({names[static_cast<std::size_t>(first + leg)], unitOf(role), role, leg});
    }
  }
  return columns;
}

}  // namespace knee_robot
