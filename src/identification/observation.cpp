#include "knee_robot/identification/observation.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/parallel.h"
#include "knee_robot/identification/motion_model.h"
#include "knee_robot/recording/filter.h"
#include "masking.h"

namespace knee_robot::identification {
namespace {

constexpr double kWideOpen = 1e6;
constexpr double kUsualCondition = 60.0;
constexpr double kVelocityNoise_m_per_s = 1e-4;

}  // namespace

int Observation::judgedSamples() const {
  return judged.empty() ? samples() : static_cast<int>(std::count(judged.begin(), judged.end(), 1));
}

int Observation::judgedRows() const {
  return judged_rows.empty() ? static_cast<int>(row_force_N.rows())
                             : static_cast<int>(std::count(judged_rows.begin(), judged_rows.end(), 1));
}

Eigen::MatrixXd judgedOnly(const std::vector<char>& judged, const Eigen::MatrixXd& values) {
  if (std::count(judged.begin(), judged.end(), 0) == 0) return values;
  std::vector<int> rows;
  for (std::size_t k = 0; k < judged.size(); ++k) {
    if (judged[k]) rows.push_back(static_cast<int>(k));
  }
  return values(rows, Eigen::all);
}

double conditionLimit(const mechanism::Robot& robot, const ObservationOptions& options) {
  if (options.condition_max > 0.0) return options.condition_max;
  const bool open = !(robot.singularity_condition_max > 0.0 && robot.singularity_condition_max < kWideOpen);
  return open ? kUsualCondition : robot.singularity_condition_max;
}

double encodersAllow(const mechanism::Robot& robot, double rate_hz) {
  double count = 0.0;
  for (const mechanism::Actuator& a : robot.actuators)
    count = std::max(count, a.metresPerCount());
  // White rounding noise, count / sqrt(12), below f, differentiated: count / sqrt(12) * sqrt(2 f / rate) * 2 pi f /
  // sqrt(3).
  const double at_1_hz = count / std::sqrt(12.0) * std::sqrt(2.0 / rate_hz) * 2.0 * kPi / std::sqrt(3.0);
  return std::pow(kVelocityNoise_m_per_s / at_1_hz, 2.0 / 3.0);
}

double velocityNoise(const mechanism::Robot& robot, double cutoff_hz, double rate_hz) {
  return kVelocityNoise_m_per_s * std::pow(cutoff_hz / encodersAllow(robot, rate_hz), 1.5);
}

double motionCutoff(const mechanism::Robot& robot, double cutoff_hz, double rate_hz) {
  return std::clamp(encodersAllow(robot, rate_hz), 3.0 * cutoff_hz, 5.0 * cutoff_hz);
}

std::vector<double> forcePerVolt(const mechanism::Robot& robot) {
  std::vector<double> factors;
  for (const mechanism::Actuator& a : robot.actuators)
    factors.push_back(a.force_sign * a.force_per_volt_N);
  return factors;
}

Observation observe(const mechanism::Robot& robot, const std::vector<Column>& columns,
                    const recording::Recording& recording, const ObservationOptions& options) {
  recording::requireAxes(recording, robot.axes(), robot.path);
  Observation o;
  o.path = recording.path;
  o.name = recording.name;
  o.fingerprint = recording.fingerprint;
  o.home_id = recording.home_id;
  o.row_time_s = recording.time_s;
  for (const mechanism::Actuator& a : robot.actuators)
    o.force_unit.push_back(mechanism::forceUnit(a));
  o.row_force_N = recording::commandedForce(recording, forcePerVolt(robot));
  recording::SignalOptions wanted = options.signals;
  if (!options.motion_cutoff_given && recording.time_s.size() > 1)
    wanted.motion_cutoff_hz = motionCutoff(robot, options.cutoff_hz, 1.0 / recording::medianPeriod(recording.time_s));
  for (const mechanism::Actuator& a : robot.actuators)
    wanted.fastest_m_per_s.push_back(a.velocity_max_m_per_s);
  for (const mechanism::Actuator& a : robot.actuators) {
    if (options.taut_steps > 0.0) wanted.taut_m.push_back(options.taut_steps * a.metresPerCount());
  }
  o.signals = recording::resample(recording, o.row_force_N, wanted);
  o.notes = o.signals.notes;
  o.warnings = o.signals.warnings;
  noteJumps(robot, o);
  const std::unique_ptr<MotionModel> model = motionModelOf(robot);
  o.motion = model->follow(o.signals);
  o.sliding = actuatorPaths(robot, o.signals);
  for (int i = 0; options.equations && i < robot.axes(); ++i)
    o.regressor.emplace_back(Eigen::MatrixXd::Zero(o.samples(), static_cast<Eigen::Index>(columns.size())));
  if (options.equations) model->fillRegressor(columns, o);
  o.cutoff_hz = options.cutoff_hz;
  o.force_filtered_N = o.signals.force_N;
  recording::ZeroPhaseLowPass(options.cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(o.force_filtered_N);
  maskUnusable(robot, options, o);
  findMoving(robot, options, o);
  return o;
}

std::vector<Observation> observeAll(const mechanism::Robot& robot, const std::vector<Column>& columns,
                                    const std::vector<recording::Recording>& recordings,
                                    const ObservationOptions& options) {
  std::vector<Observation> all(recordings.size());
  inParallel(all.size(), [&](std::size_t k) { all[k] = observe(robot, columns, recordings[k], options); });
  return all;
}

std::vector<std::string> warningsOf(const std::vector<Observation>& observations) {
  std::vector<std::string> all;
  for (const Observation& o : observations) {
    for (const std::string& warning : o.warnings)
      all.push_back(o.path + ": " + warning);
  }
  return all;
}

Eigen::VectorXd atLevel(const Observation& o, std::size_t actuator, Eigen::VectorXd share) {
  if (o.friction_level.size() > 0) share.array() *= o.friction_level.col(static_cast<Eigen::Index>(actuator)).array();
  return share;
}

void setFriction(Observation& o, const std::vector<Column>& columns, const std::vector<dynamics::FrictionLaw>& laws) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].role != ColumnRole::Coulomb) continue;
    const std::size_t i = static_cast<std::size_t>(columns[c].actuator);
    o.regressor[i].col(static_cast<Eigen::Index>(c)) =
        columns[c].newtons * atLevel(o, i, frictionShare(o.sliding[i], laws[i]));
  }
}

}  // namespace knee_robot::identification
