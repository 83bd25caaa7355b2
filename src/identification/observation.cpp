#include "knee_robot/identification/observation.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/dynamics/coulomb_memory.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/recording/filter.h"

namespace knee_robot {
namespace {

constexpr double kSaturation = 0.999;  ///< of the largest command
constexpr double kWideOpen = 1e6;
constexpr double kUsualCondition = 60.0;

std::string percent(double share) {
  return shortNumber(100.0 * share, 3) + " %";
}

/// Regressor rows of the parallel robot, with the joints' friction or without. Where the pose is not known the row before is kept;
/// such samples are masked.
void fillParallel(const Robot& robot, Observation& o) {
  RegressorData data;
  ExtendedRegressor row = ExtendedRegressor::Zero();
  ExtendedRegressor last = row;
  const Eigen::Index own = o.regressor.front().cols() - kInertialParameters;
  for (int n = 0; n < o.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    const bool known =
        o.motion.pose_known[i] && extendedRegressor(*robot.mechanism, robot.gravity, o.motion.motion[i], data, row);
    if (known) {
      last = row;
    } else {
      o.motion.pose_known[i] = 0;
    }
    for (int leg = 0; leg < kLegs; ++leg) {
      Eigen::MatrixXd& regressor = o.regressor[static_cast<std::size_t>(leg)];
      regressor.row(n).head(kInertialParameters) = last.row(leg).head(kInertialParameters);
      regressor.row(n).tail(own) = last.row(leg).tail(own);
    }
  }
}

void fillAxes(const std::vector<Column>& columns, Observation& o) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const int i = columns[c].actuator;
    Eigen::MatrixXd& regressor = o.regressor[static_cast<std::size_t>(i)];
    const Eigen::Index at = static_cast<Eigen::Index>(c);
    if (columns[c].role == ColumnRole::Viscous) regressor.col(at) = o.signals.velocity_m_per_s.col(i);
    if (columns[c].role == ColumnRole::Rotor) regressor.col(at) = o.signals.acceleration_m_per_s2.col(i);
    if (columns[c].role == ColumnRole::Offset) regressor.col(at).setOnes();
  }
}

/// Samples at which some command is at its limit.
std::vector<char> saturatedSamples(const Robot& robot, const Signals& s) {
  std::vector<char> saturated(static_cast<std::size_t>(s.samples()), 0);
  for (int i = 0; i < robot.axes(); ++i) {
    const Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    double limit = a.voltage_max_V * a.force_per_volt_N;
    if (a.force_max_N > 0.0) limit = std::min(limit, a.force_max_N);
    for (int n = 0; n < s.samples(); ++n) {
      if (std::abs(s.force_N(n, i)) >= kSaturation * limit) saturated[static_cast<std::size_t>(n)] = 1;
    }
  }
  return saturated;
}

double share(const std::vector<char>& flags) {
  return static_cast<double>(std::count(flags.begin(), flags.end(), 1)) / static_cast<double>(flags.size());
}

/// Clears `usable` at flagged samples and, as the filter spreads what is wrong there, within `reach` samples of them.
void mask(const std::vector<char>& flagged, int reach, std::vector<char>& usable) {
  const int n = static_cast<int>(flagged.size());
  for (int i = 0; i < n; ++i) {
    if (!flagged[static_cast<std::size_t>(i)]) continue;
    for (int k = std::max(0, i - reach); k <= std::min(n - 1, i + reach); ++k)
      usable[static_cast<std::size_t>(k)] = 0;
  }
}

void maskUnusable(const Robot& robot, const ObservationOptions& options, Observation& o) {
  const std::size_t n = static_cast<std::size_t>(o.samples());
  const int reach = static_cast<int>(0.25 / (options.cutoff_hz * o.signals.period_s));
  std::vector<char> unknown(n), singular(n);
  const double limit = conditionLimit(robot, options);
  for (std::size_t i = 0; i < n; ++i) {
    unknown[i] = !o.signals.known[i];
    singular[i] = robot.mechanism && (!o.motion.pose_known[i] || o.motion.condition[i] > limit);
  }
  const std::vector<char> saturated = saturatedSamples(robot, o.signals);
  o.saturated_share = share(saturated);
  o.usable.assign(n, 1);
  mask(unknown, reach, o.usable);
  mask(singular, reach, o.usable);
  mask(saturated, reach, o.usable);
  const int edge =
      std::min(o.samples() / 2, ZeroPhaseLowPass(options.cutoff_hz, 1.0 / o.signals.period_s).edgeSamples());
  std::fill_n(o.usable.begin(), edge, 0);
  std::fill_n(o.usable.rbegin(), edge, 0);
  if (robot.mechanism) {
    o.notes.push_back(percent(share(singular)) + " of the samples have a Jacobian condition above " +
                      shortNumber(limit) + " (m, rad) and are masked.");
  }
  if (o.saturated_share > 0.0) {
    o.notes.push_back("At " + percent(o.saturated_share) +
                      " of the samples a command is at its limit; they are masked.");
  }
}

void findMoving(const ObservationOptions& options, Observation& o) {
  Eigen::MatrixXd velocity = o.signals.velocity_m_per_s;
  ZeroPhaseLowPass(options.cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(velocity);
  o.axis_moving.resize(o.samples(), velocity.cols());
  o.moving.assign(static_cast<std::size_t>(o.samples()), 1);
  for (int n = 0; n < o.samples(); ++n) {
    for (int i = 0; i < velocity.cols(); ++i) {
      o.axis_moving(n, i) = std::abs(velocity(n, i)) > options.moving_m_per_s;
      if (!o.axis_moving(n, i)) o.moving[static_cast<std::size_t>(n)] = 0;
    }
  }
  o.notes.push_back("At " + percent(share(o.moving)) + " of the samples every axis is faster than " +
                    shortNumber(1e3 * options.moving_m_per_s) + " mm/s.");
}

}  // namespace

double conditionLimit(const Robot& robot, const ObservationOptions& options) {
  if (options.condition_max > 0.0) return options.condition_max;
  const bool open = !(robot.singularity_condition_max > 0.0 && robot.singularity_condition_max < kWideOpen);
  return open ? kUsualCondition : robot.singularity_condition_max;
}

std::vector<double> forcePerVolt(const Robot& robot) {
  std::vector<double> factors;
  for (const Actuator& a : robot.actuators)
    factors.push_back(a.force_sign * a.force_per_volt_N);
  return factors;
}

Observation observe(const Robot& robot, const std::vector<Column>& columns, const Recording& recording,
                    const ObservationOptions& options) {
  requireAxes(recording, robot.axes(), robot.path);
  Observation o;
  o.path = recording.path;
  o.name = recording.name;
  o.fingerprint = recording.fingerprint;
  o.row_time_s = recording.time_s;
  o.row_force_N = commandedForce(recording, forcePerVolt(robot));
  o.signals = resample(recording, o.row_force_N, options.signals);
  SignalOptions unfiltered = options.signals;
  unfiltered.motion_cutoff_hz = 1e6;
  o.fine_position_m = resample(recording, o.row_force_N, unfiltered).position_m;
  o.notes = o.signals.notes;
  o.motion = followPath(robot, o.signals);
  o.regressor.assign(static_cast<std::size_t>(robot.axes()),
                     Eigen::MatrixXd::Zero(o.samples(), static_cast<Eigen::Index>(columns.size())));
  if (robot.mechanism) {
    fillParallel(robot, o);
  } else {
    fillAxes(columns, o);
  }
  o.force_filtered_N = o.signals.force_N;
  ZeroPhaseLowPass(options.cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(o.force_filtered_N);
  maskUnusable(robot, options, o);
  findMoving(options, o);
  return o;
}

Eigen::VectorXd coulombShare(const Signals& signals, int actuator, double width_m) {
  CoulombMemory memory;
  Eigen::VectorXd out(signals.samples());
  double last = signals.position_m(0, actuator);
  for (int n = 0; n < signals.samples(); ++n) {
    out[n] = memory.step(signals.position_m(n, actuator) - last, width_m);
    last = signals.position_m(n, actuator);
  }
  return out;
}

void setCoulombWidth(Observation& o, const std::vector<Column>& columns, const std::vector<double>& width_m) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].role != ColumnRole::Coulomb) continue;
    const int i = columns[c].actuator;
    o.regressor[static_cast<std::size_t>(i)].col(static_cast<Eigen::Index>(c)) =
        coulombShare(o.signals, i, width_m[static_cast<std::size_t>(i)]);
  }
}

}  // namespace knee_robot
