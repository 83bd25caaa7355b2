#pragma once

#include <memory>
#include <vector>

#include "knee_robot/identification/columns.h"
#include "knee_robot/identification/motion_path.h"
#include "knee_robot/identification/physical_problem.h"
#include "knee_robot/identification/prediction.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::identification {

struct Observation;

/// What identification asks of a mechanism: which columns its linear model has, how it moves along a recording, and the
/// columns' entries there. One implementation a mechanism; nothing downstream asks how many legs or joints there are.
/// Refers to the robot.
class MotionModel {
 public:
  virtual ~MotionModel() = default;

  /// See columnsOf.
  virtual std::vector<Column> columns(bool joint_friction) const = 0;
  /// Forward kinematics along the samples, each starting from the one before so that the assembly branch is kept; the
  /// first from the branch in which the robot was built. Refusal when no pose of the recording can be reached by this
  /// geometry.
  virtual MotionPath follow(const recording::Signals& signals) const = 0;
  /// Fills every column of observation.regressor (zero before) but the actuators' Coulomb friction, in N of the
  /// actuator per unit of the parameter.
  virtual void fillRegressor(const std::vector<Column>& columns, Observation& observation) const = 0;
  /// Bodies by the robot's URDF, or of which only the order of magnitude is claimed: mean and unit coordinates of the
  /// rigid columns, which come first. Empty where there are none.
  virtual PhysicalCoordinates bodies() const = 0;
  /// See predictForces.
  virtual PredictedForce predict(const dynamics::Model& model, const recording::Signals& signals,
                                 const MotionPath& motion) const = 0;
};

std::unique_ptr<MotionModel> motionModelOf(const mechanism::Robot& robot);

/// Implementations; `robot` is of that kind.
std::unique_ptr<MotionModel> makeParallelModel(const mechanism::Robot& robot);
std::unique_ptr<MotionModel> makeAxesModel(const mechanism::Robot& robot);
std::unique_ptr<MotionModel> makeChainModel(const mechanism::Robot& robot);

}  // namespace knee_robot::identification
