#include "masking.h"

#include <algorithm>
#include <cmath>

#include "clipped_force.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/quantile.h"
#include "knee_robot/mechanism/singularity.h"
#include "knee_robot/recording/filter.h"

namespace knee_robot::identification {
namespace {

constexpr double kSaturation = 0.999;   ///< of the largest command
constexpr double kMovingShare = 0.015;  ///< of a joint's usual speed
constexpr double kTogether = 0.1;       ///< of the samples; below it joints move one by one
constexpr double kStand_s = 0.5;        ///< a chain that stands longer: friction may take any value

std::string percent(double share) {
  return shortNumber(100.0 * share, 3) + " %";
}

/// Samples in whose interval some row's command is at its limit, or cut off below it.
std::vector<char> saturatedSamples(const mechanism::Robot& robot, const ClippedForce& clipped, const Observation& o) {
  const recording::Signals& s = o.signals;
  std::vector<char> saturated(static_cast<std::size_t>(s.samples()), 0);
  for (std::size_t row = 0; row < o.row_time_s.size(); ++row) {
    bool at_limit = !clipped.rows.empty() && clipped.rows[row];
    for (int i = 0; i < robot.axes(); ++i) {
      const double limit = robot.actuators[static_cast<std::size_t>(i)].forceLimit();
      at_limit = at_limit || std::abs(o.row_force_N(static_cast<Eigen::Index>(row), i)) >= kSaturation * limit;
    }
    if (!at_limit) continue;
    const double until = row + 1 < o.row_time_s.size() ? o.row_time_s[row + 1] : s.time_s.back();
    const auto sample = [&](double time) {
      return static_cast<int>(std::lround((time - s.time_s.front()) / s.period_s));
    };
    for (int n = std::max(0, sample(o.row_time_s[row])); n <= std::min(s.samples() - 1, sample(until)); ++n)
      saturated[static_cast<std::size_t>(n)] = 1;
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

/// Samples of stretches longer than kStand_s in which no joint moves. A gear holds a torque that nothing tells; a stop
/// is one number, and its many samples would decide over everything that tells standing from moving.
std::vector<char> standingSamples(const Eigen::VectorXd& limits, const recording::Signals& s) {
  std::vector<char> standing(static_cast<std::size_t>(s.samples()), 0);
  const int least = static_cast<int>(kStand_s / s.period_s);
  for (int n = 0, from = 0; n <= s.samples(); ++n) {
    const bool stands =
        n < s.samples() && (s.velocity_m_per_s.row(n).cwiseAbs().transpose().array() <= limits.array()).all();
    if (stands) continue;
    if (n - from > least) std::fill(standing.begin() + from, standing.begin() + n, 1);
    from = n + 1;
  }
  return standing;
}

/// Samples at which the lengths do not tell the assembly mode: from coming within the margin of a fold until twice as
/// far away.
std::vector<char> ambiguousSamples(const mechanism::Mechanism& mechanism, double margin_m, const MotionPath& path) {
  std::vector<char> ambiguous(path.motion.size(), 0);
  bool near = false;
  for (std::size_t i = 0; margin_m > 0.0 && i < ambiguous.size(); ++i) {
    const double distance = path.pose_known[i] ? mechanism::foldDistance(mechanism, path.motion[i].pose) : 0.0;
    near = distance < (near ? 2.0 * margin_m : margin_m);
    ambiguous[i] = near;
  }
  return ambiguous;
}

void warn(std::string sentence, Observation& o) {
  o.notes.push_back(sentence);
  o.warnings.push_back(std::move(sentence));
}

void noteAmbiguous(const std::vector<char>& ambiguous, double margin_m, Observation& o) {
  const auto first = std::find(ambiguous.begin(), ambiguous.end(), 1);
  if (first == ambiguous.end()) return;
  const auto last = std::find(ambiguous.rbegin(), ambiguous.rend(), 1).base() - 1;
  const auto at = [&](std::vector<char>::const_iterator i) {
    return shortNumber(o.signals.time_s[static_cast<std::size_t>(i - ambiguous.begin())], 4) + " s";
  };
  warn("Between " + at(first) + " and " + at(last) + ", at " + percent(share(ambiguous)) +
           " of the samples, the lengths are within " + shortNumber(1e3 * margin_m) +
           " mm of a singularity where two assembly modes meet: encoders cannot tell on which of them the robot "
           "went on. They are masked until the lengths are twice as far away; what follows is taken to be the mode "
           "before.",
       o);
}

/// Rows are judged where the samples nearest to them are.
void judgeRows(Observation& o) {
  o.judged_rows.clear();
  for (const double time_s : o.row_time_s) {
    const long nearest = std::lround((time_s - o.signals.time_s.front()) / o.signals.period_s);
    o.judged_rows.push_back(
        o.judged[static_cast<std::size_t>(std::clamp<long>(nearest, 0, static_cast<long>(o.samples()) - 1))]);
  }
}

}  // namespace

void noteJumps(const mechanism::Robot& robot, Observation& o) {
  if (o.signals.jumps.empty()) return;
  const recording::Jump& jump = o.signals.jumps.front();
  const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(jump.axis)];
  const std::string unit = mechanism::positionUnit(a);
  const auto text = [&](double value_m) { return shortNumber(value_m * a.position_per_m(), 3) + " " + unit; };
  const std::size_t others = o.signals.jumps.size() - 1;
  warn("Line " + std::to_string(recording::Recording::line(jump.row)) + ": position_" + std::to_string(jump.axis + 1) +
           "_" + unit + " jumps by " + text(jump.step_m) + ", " + text(jump.m_per_s) + "/s where the limit is " +
           text(a.velocity_max_m_per_s) + "/s" +
           (jump.frozen_s > 0.0 ? ", after " + shortNumber(jump.frozen_s, 3) + " s at exactly one value: it was frozen"
                                : "") +
           (others > 0 ? " (and " + std::to_string(others) + " more such jump(s))" : "") +
           "; it is masked. Check the encoder: positions before and after may differ by as much.",
       o);
}

double usualSpeed(const recording::Signals& s, Eigen::Index actuator) {
  std::vector<double> speeds(static_cast<std::size_t>(s.samples()));
  for (int n = 0; n < s.samples(); ++n)
    speeds[static_cast<std::size_t>(n)] = std::abs(s.velocity_m_per_s(n, actuator));
  return quantile(std::move(speeds), 0.95);
}

Eigen::VectorXd movingLimits(const mechanism::Robot& robot, const ObservationOptions& options,
                             const recording::Signals& s) {
  Eigen::VectorXd limits = Eigen::VectorXd::Constant(robot.axes(), options.moving_m_per_s);
  for (Eigen::Index i = 0; robot.chain && i < limits.size(); ++i)
    limits[i] = std::min(limits[i], kMovingShare * usualSpeed(s, i));
  return limits;
}

void maskUnusable(const mechanism::Robot& robot, const ObservationOptions& options, Observation& o) {
  const std::size_t n = static_cast<std::size_t>(o.samples());
  const int reach = static_cast<int>(0.25 / (options.cutoff_hz * o.signals.period_s));
  o.usable.assign(n, 1);
  o.masks.clear();
  const auto leaveOut = [&](const std::string& reason, const std::vector<char>& flagged, int around) {
    mask(flagged, around, o.usable);
    o.masks.push_back({reason, share(flagged)});
    return o.masks.back().share;
  };

  leaveOut("in a gap between rows", o.signals.gap, reach);
  const int edge =
      std::min(o.samples() / 2, recording::ZeroPhaseLowPass(options.cutoff_hz, 1.0 / o.signals.period_s).edgeSamples());
  o.judged.assign(n, 1);
  mask(o.signals.gap, edge, o.judged);
  judgeRows(o);
  std::vector<char> pulses(n);
  for (std::size_t i = 0; i < n; ++i)
    pulses[i] = !o.signals.known[i] && !o.signals.gap[i];
  if (share(pulses) > 0.0) leaveOut("test_pulse is set: the controller asked an encoder", pulses, reach);
  const ClippedForce clipped = findClipped(robot, movingLimits(robot, options, o.signals), o);
  o.clipped = clipped.where;
  o.saturated_share = leaveOut("a command at its limit", saturatedSamples(robot, clipped, o), reach);
  if (!o.clipped.empty())
    warn(o.clipped +
             ", its own extreme, in many rows while it moves: it is cut off there, below the robot "
             "file's limit, and counts as a command at its limit.",
         o);
  if (o.saturated_share > 0.0)
    warn("At " + percent(o.saturated_share) + " of the samples a command is at its limit; they are masked.", o);
  std::vector<char> ends(n, 0);
  std::fill_n(ends.begin(), edge, 1);
  std::fill_n(ends.rbegin(), edge, 1);
  leaveOut("at the recording's ends, where the low-pass reaches beyond", ends, 0);
  if (robot.chain)
    leaveOut("all joints stand for longer than half a second",
             standingSamples(movingLimits(robot, options, o.signals), o.signals), 0);
  if (!robot.mechanism) return;

  const double limit = conditionLimit(robot, options);
  std::vector<char> singular(n), lost(n);
  for (std::size_t i = 0; i < n; ++i) {
    lost[i] = !o.motion.pose_known[i];
    singular[i] = lost[i] || o.motion.condition[i] > limit;
  }
  const double near =
      leaveOut("pose near a singularity: Jacobian condition (m, rad) above " + shortNumber(limit), singular, reach);
  o.notes.push_back(percent(near) + " of the samples have a Jacobian condition above " + shortNumber(limit) +
                    " (m, rad) and are masked.");
  const std::vector<char> ambiguous = ambiguousSamples(*robot.mechanism, options.fold_margin_m, o.motion);
  leaveOut("assembly mode uncertain: lengths within " + shortNumber(1e3 * options.fold_margin_m) + " mm of a fold",
           ambiguous, reach);
  noteAmbiguous(ambiguous, options.fold_margin_m, o);
  o.motion.uncertain.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    o.motion.uncertain[i] = singular[i] || ambiguous[i];
}

void findMoving(const mechanism::Robot& robot, const ObservationOptions& options, Observation& o) {
  const Eigen::VectorXd limits = movingLimits(robot, options, o.signals);
  Eigen::MatrixXd velocity = o.signals.velocity_m_per_s;
  recording::ZeroPhaseLowPass(options.cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(velocity);
  o.axis_moving.resize(o.samples(), velocity.cols());
  o.moving.assign(static_cast<std::size_t>(o.samples()), 1);
  for (int n = 0; n < o.samples(); ++n) {
    for (int i = 0; i < velocity.cols(); ++i) {
      o.axis_moving(n, i) = std::abs(velocity(n, i)) > limits[i];
      if (!o.axis_moving(n, i)) o.moving[static_cast<std::size_t>(n)] = 0;
    }
  }
  if (robot.chain && share(o.moving) < kTogether) {
    for (int n = 0; n < o.samples(); ++n)
      o.moving[static_cast<std::size_t>(n)] = o.axis_moving.row(n).any();
    o.notes.push_back("The joints hardly ever move together: a sample in which one moves counts as moving.");
  }
  const bool independent = !o.motion.coupled;  // bench axes: each is fitted while it moves itself
  std::vector<char> resting(o.moving.size()), used(o.moving.size());
  for (std::size_t n = 0; n < used.size(); ++n) {
    resting[n] = !o.moving[n];
    const bool moves = independent ? o.axis_moving.row(static_cast<Eigen::Index>(n)).any() : o.moving[n] != 0;
    used[n] = moves && o.usable[n];
  }
  o.masks.push_back({"some axis rests or reverses: slower than " + shortNumber(1e3 * options.moving_m_per_s) + " mm/s" +
                         (independent ? " (axes are fitted one by one)" : ""),
                     share(resting)});
  o.masks.push_back({independent ? "used in the fit of at least one axis" : "used in the fit", share(used)});
  o.notes.push_back("At " + percent(share(o.moving)) + " of the samples every axis is faster than " +
                    shortNumber(1e3 * options.moving_m_per_s) + " mm/s.");
}

}  // namespace knee_robot::identification
