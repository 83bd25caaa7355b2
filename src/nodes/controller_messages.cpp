#include "controller_messages.h"

#include <cmath>
#include <limits>

#include "knee_robot/base/constants.h"
#include "knee_robot/control/disturbance_sentences.h"
#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot::nodes {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What has been added to a histogram since `before`. The largest value is that since the start.
rt::DurationHistogram::Snapshot since(const rt::DurationHistogram::Snapshot& before,
                                      rt::DurationHistogram::Snapshot now) {
  now.count -= before.count;
  now.sum -= before.sum;
  for (std::size_t b = 0; b < now.buckets.size(); ++b)
    now.buckets[b] -= before.buckets[b];
  return now;
}

/// Remembers the limit that is nearest.
class Nearest {
 public:
  explicit Nearest(Margins& margins) : margins_(margins) { margins_.nearest_left = 1.0; }
  void consider(double left, const std::string& what) {
    if (!(left < margins_.nearest_left)) return;
    margins_.nearest_left = left;
    margins_.nearest = what;
  }

 private:
  Margins& margins_;
};

void considerAngles(const mechanism::Robot& robot, const mechanism::Pose& pose, Margins& margins, Nearest& nearest) {
  const mechanism::JointAngles angles = mechanism::jointAngles(*robot.mechanism, pose);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    margins.base_angle_rad[i] = angles.base[i];
    nearest.consider(1.0 - angles.base[i] / margins.base_angle_limit_rad[i],
                     std::string(i < 3 ? "universal" : "revolute") + " joint of leg " + std::to_string(i + 1));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    margins.platform_angle_rad[i] = angles.platform[i];
    nearest.consider(1.0 - angles.platform[i] / margins.platform_angle_limit_rad[i],
                     "spherical joint of leg " + std::to_string(i + 1));
  }
  margins.condition = mechanism::conditionNumber(*robot.mechanism, pose);
  if (std::isfinite(margins.condition_limit))
    nearest.consider(1.0 - margins.condition / margins.condition_limit, "singularity");
}

}  // namespace

sensor_msgs::JointState coordinatesMessage(const mechanism::Mechanism& mechanism, const mechanism::Pose& pose,
                                           const control::TrackingRow& row) {
  static const std::array<const char*, 15> names = {"q11", "q12", "q13", "q21", "q22", "q23",   "q31", "q32",
                                                    "q33", "q41", "q42", "Xm",  "Zm",  "theta", "psi"};
  sensor_msgs::JointState message;
  message.name.assign(names.begin(), names.end());
  message.effort.assign(names.size(), 0.0);
  const mechanism::JointCoordinates q = mechanism::inverseKinematics(mechanism, pose);
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double value : {q.q1[i], q.q2[i], q.q3[i]})
      message.position.push_back(value);
    message.effort[3 * i + 2] = row.force_N[i];
  }
  message.position.insert(message.position.end(), {q.q41, q.q42});
  message.position.insert(message.position.end(), pose.data(), pose.data() + 4);
  message.effort[10] = row.force_N[3];

  mechanism::Motion motion;
  motion.pose = pose;
  const mechanism::Vector4 rates(row.velocity_m_per_s.data());
  if (!mechanism::poseRates(mechanism, pose, rates, mechanism::Vector4::Zero(), motion.pose_velocity,
                            motion.pose_acceleration))
    return message;
  mechanism::RobotMotion legs;
  mechanism::robotMotion(mechanism, motion, legs);
  for (std::size_t i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k)
      message.velocity.push_back(legs.legs[i].rate[k]);
  }
  message.velocity.insert(message.velocity.end(), {legs.legs[3].rate[1], legs.legs[3].rate[2]});
  message.velocity.insert(message.velocity.end(), motion.pose_velocity.data(), motion.pose_velocity.data() + 4);
  return message;
}

sensor_msgs::JointState urdfJointsMessage(const mechanism::Mechanism& mechanism, const mechanism::Pose& pose) {
  sensor_msgs::JointState message;
  const auto& names = mechanism::urdfJointNames();
  const auto positions = mechanism::urdfJointPositions(mechanism, pose);
  message.name.assign(names.begin(), names.end());
  message.position.assign(positions.begin(), positions.end());
  return message;
}

Margins marginsMessage(const mechanism::Robot& robot, const mechanism::Pose* pose, const control::TrackingRow& row) {
  Margins margins;
  Nearest nearest(margins);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const mechanism::Actuator& actuator = robot.actuators[i];
    margins.length_m[i] = row.position_m[i];
    margins.length_min_m[i] = actuator.position_min_m;
    margins.length_max_m[i] = actuator.position_max_m;
    margins.base_angle_limit_rad[i] = i < 3 ? robot.joints.universal_max : robot.joints.revolute_max;
    margins.base_angle_rad[i] = kNan;
    const double range = actuator.position_max_m - actuator.position_min_m;
    const std::string leg = "length of leg " + std::to_string(i + 1);
    nearest.consider((row.position_m[i] - actuator.position_min_m) / range, "shortest " + leg);
    nearest.consider((actuator.position_max_m - row.position_m[i]) / range, "longest " + leg);
  }
  margins.platform_angle_limit_rad.assign(robot.joints.spherical_max);
  margins.platform_angle_rad.assign(kNan);
  margins.condition = kNan;
  margins.condition_limit = robot.mechanism ? robot.singularity_condition_max : kInfinity;
  margins.pose_known = pose != nullptr && robot.mechanism;
  if (margins.pose_known) considerAngles(robot, *pose, margins, nearest);
  return margins;
}

Timing timingMessage(const rt::Deployment& deployment, std::vector<rt::DurationHistogram::Snapshot>& before) {
  Timing message;
  std::vector<rt::DurationHistogram::Snapshot> now;
  for (const auto& activity : deployment.activities()) {
    const rt::ActivityStatistics& statistics = activity->statistics();
    ActivityTiming timing;
    timing.name = activity->name();
    timing.period_s = rt::toSeconds(activity->options().period);
    timing.cycles = statistics.cycles.load();
    timing.missed = statistics.missed.load();
    timing.overruns = statistics.overruns.load();
    const std::size_t k = now.size();
    now.push_back(statistics.lateness.snapshot());
    now.push_back(statistics.execution.snapshot());
    if (before.size() < now.size()) before.resize(now.size());
    const auto lateness = since(before[k], now[k]), execution = since(before[k + 1], now[k + 1]);
    timing.lateness_mean_s = 1e-9 * lateness.mean();
    timing.lateness_p99_s = rt::toSeconds(lateness.quantile(0.99));
    timing.lateness_max_s = rt::toSeconds(lateness.max);
    timing.execution_mean_s = 1e-9 * execution.mean();
    timing.execution_p99_s = rt::toSeconds(execution.quantile(0.99));
    timing.execution_max_s = rt::toSeconds(execution.max);
    message.activities.push_back(timing);
  }
  before = std::move(now);
  return message;
}

Residual residualMessage(const control::Disturbance& disturbance) {
  Residual message;
  message.known = disturbance.known;
  message.identified = disturbance.identified;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    message.expected_N[i] = disturbance.expected_N[i];
    message.residual_N[i] = disturbance.residual_N[i];
    message.certain_N[i] = disturbance.certain_N[i];
    message.rms_N[i] = disturbance.rms_N[i];
    message.band_N[i] = disturbance.band_N[i];
    message.wrench[i] = disturbance.wrench[i];
    message.wrench_band[i] = disturbance.wrench_band[i];
    message.pose[i] = disturbance.pose[i];
    message.friction_growth[i] = disturbance.friction_growth[i];
  }
  message.load_kg = disturbance.load_kg;
  for (const control::Notice& notice : control::noticesOf(disturbance))
    (notice.level == control::Notice::Level::Error ? message.errors : message.warnings).push_back(notice.sentence);
  return message;
}

}  // namespace knee_robot::nodes
