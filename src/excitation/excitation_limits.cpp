#include "knee_robot/excitation/excitation_limits.h"

#include <algorithm>
#include <cmath>

#include "excitation_problem.h"

namespace knee_robot::excitation {
namespace {

/// Keeps the closest approach of each quantity, in the order in which they first come.
class Closest {
 public:
  void take(const std::string& name, double value, double limit, double share, double time_s) {
    const auto same = [&](const LimitUsed& used) { return used.name == name; };
    const auto found = std::find_if(all_.begin(), all_.end(), same);
    if (found == all_.end()) {
      all_.push_back({name, value, limit, share, time_s});
    } else if (share > found->share) {
      *found = {name, value, limit, share, time_s};
    }
  }
  std::vector<LimitUsed> all() const { return all_; }

 private:
  std::vector<LimitUsed> all_;
};

void takeMotion(const mechanism::Robot& robot, const SeriesPoint& point, double time_s, Closest& closest) {
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::Actuator& a = robot.actuators[i];
    const std::string of = " of actuator " + std::to_string(i + 1);
    const double middle = 0.5 * (a.position_min_m + a.position_max_m), half = a.position_max_m - middle;
    const double length = point.value[i];
    closest.take("length" + of, length, length < middle ? a.position_min_m : a.position_max_m,
                 std::abs(length - middle) / half, time_s);
    const double speed = std::abs(point.rate[i]), acceleration = std::abs(point.acceleration[i]);
    closest.take("velocity" + of, speed, a.velocity_max_m_per_s, speed / a.velocity_max_m_per_s, time_s);
    closest.take("acceleration" + of, acceleration, a.acceleration_max_m_per_s2,
                 acceleration / a.acceleration_max_m_per_s2, time_s);
  }
}

void takePose(const mechanism::Robot& robot, const mechanism::Pose& pose, double time_s, Closest& closest) {
  const mechanism::JointAngles angles = mechanism::jointAngles(*robot.mechanism, pose);
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const std::string of = " of leg " + std::to_string(i + 1);
    const double base_max = i < 3 ? robot.joints.universal_max : robot.joints.revolute_max;
    closest.take((i < 3 ? "universal joint" : "revolute joint") + of, angles.base[i], base_max,
                 angles.base[i] / base_max, time_s);
    if (i == 3) continue;
    const double tip_max = robot.joints.spherical_max;
    closest.take("spherical joint" + of, angles.platform[i], tip_max, angles.platform[i] / tip_max, time_s);
  }
  const double condition = mechanism::conditionNumber(*robot.mechanism, pose), most = robot.singularity_condition_max;
  closest.take("condition number", condition, most, condition / most, time_s);
}

}  // namespace

std::optional<std::vector<LimitUsed>> limitsUsed(const mechanism::Robot& robot, const FourierSeries& series,
                                                 const ExpectedFriction& friction, double step_s) {
  const std::optional<ExpectedLoad> load = expectedLoad(robot, friction);
  const mechanism::ForwardResult start = mechanism::forwardKinematicsFromHome(*robot.mechanism, series.centre);
  if (!start.ok()) return std::nullopt;
  mechanism::Motion motion;
  motion.pose = start.pose;
  dynamics::RegressorData data;
  Closest closest;
  mechanism::Vector4 squares = mechanism::Vector4::Zero();
  const long last = std::lround(series.shape.duration_s / step_s);
  for (long k = 0; k <= last; ++k) {
    const double time = static_cast<double>(k) * step_s;
    const SeriesPoint point = pointAt(series, seriesBasis(series.shape, time));
    if (mechanism::motionFromLengths(*robot.mechanism, point.value, point.rate, point.acceleration, motion.pose,
                                     motion) != mechanism::ForwardStatus::Converged) {
      return std::nullopt;
    }
    takeMotion(robot, point, time, closest);
    takePose(robot, motion.pose, time, closest);
    if (!load || !dynamics::projectedRegressor(*robot.mechanism, robot.gravity, motion, data)) continue;
    const mechanism::Vector4 force = data.k * load->parameters + load->rotor_mass.cwiseProduct(point.acceleration);
    squares += force.cwiseAbs2();
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const double most = robot.actuators[i].forceLimit(), size = std::abs(force[i]);
      closest.take("peak force of actuator " + std::to_string(i + 1), size, most, size / most, time);
    }
  }
  for (int i = 0; load && i < mechanism::kLegs; ++i) {
    const double most = robot.actuators[i].force_continuous_N;
    const double rms = std::sqrt(squares[i] / static_cast<double>(last + 1));
    if (most > 0.0) closest.take("rms force of actuator " + std::to_string(i + 1), rms, most, rms / most, 0.0);
  }
  return closest.all();
}

}  // namespace knee_robot::excitation
