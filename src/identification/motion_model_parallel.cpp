#include <cmath>
#include <limits>

#include "force_model_prediction.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/identification/motion_model.h"
#include "knee_robot/identification/observation.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/mechanism/singularity.h"

namespace knee_robot::identification {
namespace {

constexpr double kLongest_m = 50.0;  ///< beyond, a length is no length of a robot in metres

constexpr double kLink_kg = 5.0, kPlatform_kg = 10.0, kGyration_m = 0.2;

dynamics::RobotInertia bodiesWithoutUrdf() {
  dynamics::RobotInertia inertia;
  for (int link = 0; link < dynamics::kLinks; ++link) {
    dynamics::LinkInertia& body = inertia.links[static_cast<std::size_t>(link)];
    body.mass = link == dynamics::kPlatformLink ? kPlatform_kg : kLink_kg;
    body.center.setZero();
    body.inertia = body.mass * kGyration_m * kGyration_m * mechanism::Matrix3::Identity();
  }
  return inertia;
}

/// Regressor rows of the parallel robot, with the joints' friction or without. Where the pose is not known the row
/// before is kept; such samples are masked.
void fillParallel(const mechanism::Robot& robot, Observation& o) {
  dynamics::RegressorData data;
  dynamics::ExtendedRegressor row = dynamics::ExtendedRegressor::Zero();
  dynamics::ExtendedRegressor last = row;
  const Eigen::Index own = o.regressor.front().cols() - dynamics::kInertialParameters;
  for (int n = 0; n < o.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    const bool known = o.motion.pose_known[i] &&
                       dynamics::extendedRegressor(*robot.mechanism, robot.gravity, o.motion.motion[i], data, row);
    if (known) {
      last = row;
    } else {
      o.motion.pose_known[i] = 0;
    }
    for (int leg = 0; leg < mechanism::kLegs; ++leg) {
      Eigen::MatrixXd& regressor = o.regressor[static_cast<std::size_t>(leg)];
      regressor.row(n).head(dynamics::kInertialParameters) = last.row(leg).head(dynamics::kInertialParameters);
      regressor.row(n).tail(own) = last.row(leg).tail(own);
    }
  }
  if (own < dynamics::extended::kParameters - dynamics::kInertialParameters) return;
  const PassiveCoulomb passive(robot, o.signals, o.motion);
  for (int n = 0; n < o.samples(); ++n) {
    for (int joint = 0; joint < PassiveCoulomb::kJoints; ++joint) {
      const mechanism::Vector4 column = passive.column(n, joint);
      for (int leg = 0; leg < mechanism::kLegs; ++leg)
        o.regressor[static_cast<std::size_t>(leg)](n, dynamics::extended::kPassiveFriction + 2 * joint + 1) =
            column[leg];
    }
  }
}

/// The 3UPS+1RPU parallel robot.
class ParallelModel : public MotionModel {
 public:
  explicit ParallelModel(const mechanism::Robot& robot) : robot_(robot) {}

  std::vector<Column> columns(bool joint_friction) const override;
  MotionPath follow(const recording::Signals& signals) const override;
  void fillRegressor(const std::vector<Column>&, Observation& o) const override { fillParallel(robot_, o); }
  PhysicalCoordinates bodies() const override {
    return physicalCoordinates(robot_.urdf.empty() ? bodiesWithoutUrdf() : dynamics::loadRobotInertia(robot_));
  }
  PredictedForce predict(const dynamics::Model& model, const recording::Signals& signals,
                         const MotionPath& motion) const override {
    return predictByForceModel(model, robot_, signals, motion);
  }

 private:
  const mechanism::Robot& robot_;
};

std::vector<Column> ParallelModel::columns(bool joint_friction) const {
  std::vector<Column> columns;
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

MotionPath ParallelModel::follow(const recording::Signals& signals) const {
  MotionPath path;
  const std::size_t n = static_cast<std::size_t>(signals.samples());
  path.pose_known.assign(n, 1);
  path.condition.assign(n, 1.0);
  path.coupled = true;
  path.motion.resize(n);
  mechanism::Motion last;
  bool have_last = false;
  std::size_t lost = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const int sample = static_cast<int>(i);
    const mechanism::Lengths lengths = actuatorRow(signals.position_m, sample);
    mechanism::Pose guess = last.pose;
    bool ok = have_last;
    if (!have_last) {
      const mechanism::ForwardResult home = mechanism::forwardKinematicsFromHome(*robot_.mechanism, lengths);
      ok = home.ok();
      guess = home.pose;
    }
    ok = ok && mechanism::motionFromLengths(*robot_.mechanism, lengths, actuatorRow(signals.velocity_m_per_s, sample),
                                            actuatorRow(signals.acceleration_m_per_s2, sample), guess,
                                            path.motion[i]) == mechanism::ForwardStatus::Converged;
    if (ok) {
      last = path.motion[i];
      have_last = true;
      path.condition[i] = mechanism::conditionNumber(*robot_.mechanism, last.pose);
      continue;
    }
    ++lost;
    path.motion[i] = last;
    path.motion[i].pose_velocity.setZero();
    path.motion[i].pose_acceleration.setZero();
    path.pose_known[i] = 0;
    path.condition[i] = std::numeric_limits<double>::infinity();
  }
  if (lost == n) {
    throw Refusal("the geometry of " + robot_.path + " reaches none of the recorded lengths (first: " +
                  shortNumber(std::round(1e6 * signals.position_m(0, 0)) / 1e6) + " m for actuator 1); " +
                  (signals.position_m(0, 0) > kLongest_m
                       ? "are these millimetres? import_recording makes metres of them (--column 'FROM=TO,mm')"
                       : "is this recording from that robot?"));
  }
  return path;
}

}  // namespace

std::unique_ptr<MotionModel> makeParallelModel(const mechanism::Robot& robot) {
  return std::make_unique<ParallelModel>(robot);
}

}  // namespace knee_robot::identification
