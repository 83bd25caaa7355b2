#include "knee_robot/identification/plausible_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "knee_robot/recording/filter.h"
#include "other_forces.h"
#include "shifted_clock.h"
#include "wrong_units.h"

namespace knee_robot::identification {
namespace {

// Of the force's rms. Recordings of real robots leave up to 20 % in training; half is no description any more.
constexpr double kLooksWrong = 0.25;  ///< from here on other signs and orders are tried
constexpr double kNoFit = 0.5;
constexpr double kMuchBetter = 0.5;        ///< of the error: what a wrong sign or order must leave at most
constexpr double kAsGood = 1.1;            ///< of the best squared error: then the smaller change is the explanation
constexpr double kClockLooksWrong = 0.05;  ///< of what varies in a force: from here on other times are tried
constexpr std::size_t kMostFlips = 7;      ///< actuators whose signs are combined: 128 fits

/// Which recorded force every actuator is fitted to, and with which sign.
struct Reading {
  std::vector<int> source;
  std::vector<double> sign;
  std::string change;    ///< "with the sign of its force reversed"
  std::string question;  ///< what to look at
  std::vector<int> who;  ///< actuators that it changes
};

std::string whoAre(const mechanism::Robot& robot, const std::vector<int>& who) {
  if (static_cast<int>(who.size()) == robot.axes() && who.size() > 2) return "all actuators";
  return joined(who, [&](int i) { return whoIs(robot, i); });
}

/// rms of what the model leaves, usable samples, per actuator: over rms of the force, and over that about its mean.
struct Left {
  Eigen::VectorXd of_force, of_what_varies;
};

Left leftBy(const Eigen::VectorXd& parameters, const std::vector<Observation>& training, double cutoff_hz) {
  const int axes = training.front().axes();
  Eigen::ArrayXd left = Eigen::ArrayXd::Zero(axes), whole = left, sum = left;
  double samples = 0.0;
  for (const Observation& o : training) {
    Eigen::MatrixXd force(o.samples(), axes);
    for (int i = 0; i < axes; ++i)
      force.col(i) = o.regressor[static_cast<std::size_t>(i)] * parameters;
    recording::ZeroPhaseLowPass(cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(force);
    for (int n = 0; n < o.samples(); ++n) {
      if (!o.usable[static_cast<std::size_t>(n)]) continue;
      const Eigen::ArrayXd measured = o.force_filtered_N.row(n).transpose().array();
      left += (measured - force.row(n).transpose().array()).square();
      whole += measured.square();
      sum += measured;
      samples += 1.0;
    }
  }
  const Eigen::ArrayXd varies = whole - sum.square() / std::max(1.0, samples);
  return {(left / whole.max(1e-300)).sqrt(), (left / varies.max(1e-300)).sqrt()};
}

/// Dry and viscous friction both ended at zero.
std::vector<char> withoutFriction(const std::vector<Column>& columns, const Eigen::VectorXd& parameters, int axes) {
  std::vector<char> none(static_cast<std::size_t>(axes), 1);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool friction = columns[c].role == ColumnRole::Viscous || columns[c].role == ColumnRole::Coulomb;
    if (friction && parameters[static_cast<Eigen::Index>(c)] > 0.0)
      none[static_cast<std::size_t>(columns[c].actuator)] = 0;
  }
  return none;
}

Reading asRecorded(int axes) {
  Reading r;
  r.source.resize(static_cast<std::size_t>(axes));
  std::iota(r.source.begin(), r.source.end(), 0);
  r.sign.assign(static_cast<std::size_t>(axes), 1.0);
  return r;
}

Reading flipped(int axes, const std::vector<int>& who) {
  Reading r = asRecorded(axes);
  for (const int i : who)
    r.sign[static_cast<std::size_t>(i)] = -1.0;
  r.who = who;
  const bool one = who.size() == 1;
  r.change = one ? "with the sign of its force reversed" : "with the signs of their forces reversed";
  r.question = one ? "is the sign of its force, or that of its position, wrong in the recording?"
                   : "are the signs of the forces, or those of the positions, wrong in the recording?";
  return r;
}

/// Signs of those that look wrong in all combinations, few first; two forces exchanged; all in reverse order.
std::vector<Reading> otherReadings(int axes, const std::vector<int>& wrong) {
  std::vector<Reading> list;
  const std::size_t flips = std::min(wrong.size(), kMostFlips);
  for (unsigned bits = 1; bits < (1u << flips); ++bits) {
    std::vector<int> who;
    for (std::size_t k = 0; k < flips; ++k) {
      if (bits & (1u << k)) who.push_back(wrong[k]);
    }
    list.push_back(flipped(axes, who));
  }
  std::vector<int> all = asRecorded(axes).source;
  list.push_back(flipped(axes, all));
  std::stable_sort(list.begin(), list.end(),
                   [](const Reading& a, const Reading& b) { return a.who.size() < b.who.size(); });
  for (int i = 0; i < axes; ++i) {
    for (int k = i + 1; k < axes; ++k) {
      Reading r = asRecorded(axes);
      std::swap(r.source[static_cast<std::size_t>(i)], r.source[static_cast<std::size_t>(k)]);
      r.who = {i, k};
      r.change = "with their forces exchanged";
      r.question = "are the columns of forces, or those of positions, exchanged in the recording?";
      list.push_back(r);
    }
  }
  if (axes > 3) {
    Reading r = asRecorded(axes);
    std::reverse(r.source.begin(), r.source.end());
    r.who = all;
    r.change = "with the forces in reverse order";
    r.question = "are the columns in the order of the robot file?";
    list.push_back(r);
  }
  return list;
}

/// The equations of every actuator beside the forces of all: any reading of the recording can be fitted to them.
class Readings {
 public:
  explicit Readings(const OtherForces& equations) : equations_(equations) {
    const Eigen::MatrixXd forces = equations.recorded();
    for (int i = 0; i < equations.axes(); ++i)
      blocks_.push_back(equations.beside(i, forces));
  }

  /// rms error over the spread of the force, per actuator.
  Eigen::VectorXd errorOf(const Reading& r) const {
    std::vector<OtherForces::Force> forces;
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      forces.push_back({r.source[i], r.sign[i], r.source[i]});
    return equations_.errorOf(blocks_, forces);
  }

  /// The one that explains much more than the recording as it is; null: none.
  const Reading* better(const std::vector<Reading>& others, const Eigen::VectorXd& as_recorded) const {
    std::vector<double> squares;
    for (const Reading& r : others)
      squares.push_back(errorOf(r).squaredNorm());
    const double least = *std::min_element(squares.begin(), squares.end());
    if (least > kMuchBetter * kMuchBetter * as_recorded.squaredNorm()) return nullptr;
    for (std::size_t k = 0; k < others.size(); ++k) {
      if (squares[k] <= kAsGood * least) return &others[k];
    }
    return nullptr;
  }

 private:
  const OtherForces& equations_;
  std::vector<Eigen::MatrixXd> blocks_;  ///< per actuator: its columns, then the forces of all
};

std::string shareText(double share) {
  const double percent = 100.0 * share;
  return (percent < 10.0 ? shortNumber(percent, 2) : shortNumber(std::round(percent), 9)) + " %";
}

/// What a wrong sign or order explains; empty when nothing does.
std::string betterReading(const mechanism::Robot& robot, const std::vector<Column>& columns,
                          const std::vector<Observation>& training, const ObservationOptions& options,
                          const std::vector<int>& wrong) {
  const OtherForces equations(robot, columns, training, options, narrowStops(robot));
  const Readings readings(equations);
  const std::vector<Reading> others = otherReadings(robot.axes(), wrong);
  const Eigen::VectorXd before = readings.errorOf(asRecorded(robot.axes()));
  const Reading* best = readings.better(others, before);
  if (best == nullptr) return "";
  Eigen::Index worst = 0;
  before.maxCoeff(&worst);
  const Eigen::VectorXd after = readings.errorOf(*best);
  const auto source = std::find(best->source.begin(), best->source.end(), static_cast<int>(worst));
  return whoAre(robot, best->who) + ": " + best->change + " the model leaves " +
         shareText(after[source - best->source.begin()]) + " of what varies in the force of " +
         whoIs(robot, static_cast<int>(worst)) + ", as recorded " + shareText(before[worst]) + ": " + best->question;
}

}  // namespace

std::vector<std::string> doubtsAboutFit(const mechanism::Robot& robot, const std::vector<Column>& columns,
                                        const Eigen::VectorXd& parameters, const std::vector<Observation>& training,
                                        const ObservationOptions& options) {
  if (const std::string units = doubtAboutUnits(robot, columns, training); !units.empty()) return {units};
  const Left left = leftBy(parameters, training, options.cutoff_hz);
  const std::vector<char> frictionless = withoutFriction(columns, parameters, robot.axes());
  std::vector<int> wrong, opposed, bad;
  for (int i = 0; i < robot.axes(); ++i) {
    const bool none = frictionless[static_cast<std::size_t>(i)] != 0;
    if (none || left.of_force[i] > kLooksWrong) wrong.push_back(i);
    if (left.of_force[i] > kNoFit) (none ? opposed : bad).push_back(i);
  }
  if (!wrong.empty()) {
    const std::string better = betterReading(robot, columns, training, options, wrong);
    if (!better.empty()) return {better};
  }
  if (left.of_what_varies.maxCoeff() > kClockLooksWrong) {
    const std::string shifted = doubtAboutClocks(robot, columns, training, options);
    if (!shifted.empty()) return {shifted};
  }
  if (wrong.empty()) return {};
  std::vector<std::string> doubts;
  for (const int i : opposed) {
    if (!bad.empty()) break;  // then it is not one actuator's sign
    doubts.push_back(whoIs(robot, i) +
                     ": the recorded force opposes what friction needs (dry and viscous friction end at zero, " +
                     shareText(left.of_force[i]) +
                     " of the rms force is left): is its sign, or that of its position, wrong, or "
                     "are columns swapped?");
  }
  if (bad.empty()) return doubts;
  bad.insert(bad.end(), opposed.begin(), opposed.end());
  std::sort(bad.begin(), bad.end());
  return {"The model does not describe these data at all: of the rms force of training it leaves " +
          joined(bad, [&](int i) { return shareText(left.of_force[i]) + " at " + whoIs(robot, i); }) +
          ". Check units, order and signs of the columns, and the robot file" +
          (robot.urdf.empty() ? "" : " with its URDF (kg, m)") + "."};
}

}  // namespace knee_robot::identification
