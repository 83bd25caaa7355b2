#include "shifted_clock.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "other_forces.h"

namespace knee_robot::identification {
namespace {

constexpr double kShifts_s[] = {0.125, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
constexpr double kNearTheBestShift[] = {0.8, 0.85, 0.9, 0.95, 1.05, 1.1, 1.15, 1.2};
const double kSpeedsTried_m_per_s[] = {5e-4, 2e-3};  ///< of tanh, beside narrow stops
constexpr double kMuchBetterShifted = 0.5;           ///< of the error

/// The signal that was recorded `later_s` after each sample; at the ends, where nothing was, the outermost.
Eigen::VectorXd takenLater(const Eigen::VectorXd& force, double later_s, double period_s) {
  Eigen::VectorXd out(force.size());
  const Eigen::Index last = force.size() - 1;
  for (Eigen::Index n = 0; n <= last; ++n) {
    const double place = std::clamp(static_cast<double>(n) + later_s / period_s, 0.0, static_cast<double>(last));
    const Eigen::Index before = std::min(static_cast<Eigen::Index>(place), std::max<Eigen::Index>(0, last - 1));
    const double share = place - static_cast<double>(before);
    out[n] = (1.0 - share) * force[before] + share * force[std::min(last, before + 1)];
  }
  return out;
}

/// rms error over what varies in the force, per actuator and time.
Eigen::MatrixXd errorsOf(const OtherForces& equations, const std::vector<double>& later_s) {
  const Eigen::Index times = static_cast<Eigen::Index>(later_s.size());
  std::vector<Eigen::MatrixXd> blocks;
  std::vector<OtherForces::Force> force;
  for (int i = 0; i < equations.axes(); ++i) {
    std::vector<Eigen::MatrixXd> forces;
    for (const Observation& o : equations.training()) {
      forces.emplace_back(o.samples(), times);
      for (Eigen::Index k = 0; k < times; ++k)
        forces.back().col(k) =
            takenLater(o.signals.force_N.col(i), later_s[static_cast<std::size_t>(k)], o.signals.period_s);
    }
    blocks.push_back(equations.beside(i, equations.at(i, std::move(forces))));
    force.push_back({0, 1.0, i});
  }
  Eigen::MatrixXd errors(equations.axes(), times);
  for (Eigen::Index k = 0; k < times; ++k) {
    for (OtherForces::Force& f : force)
      f.column = k;
    errors.col(k) = equations.errorOf(blocks, force);
  }
  return errors;
}

/// A time at which forces are taken, and what is left with them, per actuator.
struct Shift {
  double later_s = 0.0;
  Eigen::VectorXd error;
};

Shift leastOfShifts(const OtherForces& equations, const std::vector<double>& later_s) {
  const Eigen::MatrixXd errors = errorsOf(equations, later_s);
  Eigen::Index least = 0;
  errors.colwise().squaredNorm().minCoeff(&least);
  return {later_s[static_cast<std::size_t>(least)], errors.col(least)};
}

void keepBetter(const Shift& other, Shift& best) {
  if (best.error.size() == 0 || other.error.norm() < best.error.norm()) best = other;
}

/// Laws near rest, of which the best is believed: one that builds up too fast or too late looks like another time.
std::vector<std::vector<dynamics::FrictionLaw>> lawsToTry(const mechanism::Robot& robot) {
  std::vector<std::vector<dynamics::FrictionLaw>> all = {narrowStops(robot)};
  for (const double speed : kSpeedsTried_m_per_s)
    all.emplace_back(static_cast<std::size_t>(robot.axes()), dynamics::smoothLaw(speed));
  return all;
}

}  // namespace

std::string doubtAboutClocks(const mechanism::Robot& robot, const std::vector<Column>& columns,
                             const std::vector<Observation>& training, const ObservationOptions& options) {
  std::vector<double> tried;
  for (const double shift : kShifts_s)
    tried.insert(tried.end(), {shift, -shift});
  Shift as_recorded, best;
  for (const std::vector<dynamics::FrictionLaw>& laws : lawsToTry(robot)) {
    const OtherForces equations(robot, columns, training, options, laws);
    keepBetter(leastOfShifts(equations, {0.0}), as_recorded);
    const Shift coarse = leastOfShifts(equations, tried);
    std::vector<double> near = {coarse.later_s};
    for (const double factor : kNearTheBestShift)
      near.push_back(factor * coarse.later_s);
    keepBetter(leastOfShifts(equations, near), best);
  }
  if (best.error.norm() > kMuchBetterShifted * as_recorded.error.norm()) return "";
  Eigen::Index worst = 0;
  as_recorded.error.maxCoeff(&worst);
  const auto percent = [](double share) { return shortNumber(100.0 * share, 2) + " %"; };
  return "With the forces recorded " + shortNumber(std::abs(best.later_s), 2) + " s " +
         (best.later_s > 0.0 ? "later" : "before") + " the positions the model leaves " + percent(best.error[worst]) +
         " of what varies in the force of " + whoIs(robot, static_cast<int>(worst)) + ", with those of the same time " +
         percent(as_recorded.error[worst]) +
         ": were forces and positions stamped by different clocks, or forces stamped when they arrived?";
}

}  // namespace knee_robot::identification
