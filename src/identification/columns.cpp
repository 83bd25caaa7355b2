#include "knee_robot/identification/columns.h"

#include "knee_robot/dynamics/model.h"
#include "knee_robot/dynamics/parameters.h"

namespace knee_robot::identification {
namespace {

std::string rigidUnit(int column) {
  const int place = column % dynamics::kLinkParameters;  // Ixx Ixy Ixz Iyy Iyz Izz mx my mz m
  if (place == dynamics::kLinkParameters - 1) return "kg";
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

std::vector<Column> columnsOf(const mechanism::Robot& robot, bool joint_friction) {
  std::vector<Column> columns;
  if (robot.kind == mechanism::MechanismKind::Axes) {
    const std::vector<std::string> names = dynamics::axisParameterNames(robot.axes());
    const ColumnRole roles[] = {ColumnRole::Viscous, ColumnRole::Coulomb, ColumnRole::Rotor, ColumnRole::Offset};
    for (std::size_t i = 0; i < names.size(); ++i) {
      columns.push_back({names[i], unitOf(roles[i % 4]), roles[i % 4], static_cast<int>(i / 4)});
    }
    return columns;
  }
  const std::vector<std::string>& names = dynamics::extendedParameterNames();
  for (int i = 0; i < dynamics::kInertialParameters; ++i) {
    columns.push_back({names[static_cast<std::size_t>(i)], rigidUnit(i), ColumnRole::Rigid, -1});
  }
  for (int i = 0; joint_friction && i < dynamics::extended::kPassiveFrictionCount; ++i) {
    const bool viscous = i % 2 == 0;
    columns.push_back({names[static_cast<std::size_t>(dynamics::extended::kPassiveFriction + i)],
                       viscous ? "N m s/rad" : "N m", ColumnRole::JointFriction, -1});
  }
  const std::pair<ColumnRole, int> blocks[] = {{ColumnRole::Viscous, dynamics::extended::kViscous},
                                               {ColumnRole::Coulomb, dynamics::extended::kCoulomb},
                                               {ColumnRole::Rotor, dynamics::extended::kRotor},
                                               {ColumnRole::Offset, dynamics::extended::kOffset}};
  for (const auto& [role, first] : blocks) {
    for (int leg = 0; leg < mechanism::kLegs; ++leg) {
      columns.push_back({names[static_cast<std::size_t>(first + leg)], unitOf(role), role, leg});
    }
  }
  return columns;
}

}  // namespace knee_robot::identification
