#pragma once

#include <string>
#include <vector>

#include "knee_robot/mechanism/robot.h"

namespace knee_robot::identification {

/// What a column of the linear model stands for.
enum class ColumnRole { Rigid, JointFriction, Viscous, Coulomb, Rotor, Offset };

/// One column of the linear model that is identified.
struct Column {
  std::string name;  ///< as in the model file
  std::string unit;
  ColumnRole role = ColumnRole::Rigid;
  int actuator = -1;  ///< -1: concerns all actuators
  /// Of friction, rotor and offset: N, N s/m or kg of the actuator that one unit of the parameter is. 1 but for
  /// revolute joints, whose parameters are in N m, N m s/rad and kg m^2 (mechanism::kJointRadius_m).
  double newtons = 1.0;
  /// Parameters with a physical sign are kept apart from the rank truncation and never become negative.
  bool isNonNegative() const { return isFriction() || role == ColumnRole::Rotor; }
  bool isFriction() const {
    return role == ColumnRole::JointFriction || role == ColumnRole::Viscous || role == ColumnRole::Coulomb;
  }
};

/// Columns that are identified for this robot. Parallel robot: 90 rigid, with `joint_friction` viscous and Coulomb
/// friction of the legs' seven passive joints (eq. (22)-(23)), then viscous, Coulomb, rotor and offset of the four
/// actuators. The joints' own friction is left out unless asked for: on recordings of real robots of this kind it is
/// hardly told apart from the actuators' friction, and made the error on another trajectory larger. Bench axes:
/// viscous, Coulomb, rotor, offset per axis.
std::vector<Column> columnsOf(const mechanism::Robot& robot, bool joint_friction = false);

/// Unit of a rigid column, by its place among the links' ten parameters, and of a column of one actuator or revolute
/// joint.
std::string rigidUnit(int column);
const char* unitOf(ColumnRole role, bool revolute = false);

}  // namespace knee_robot::identification
