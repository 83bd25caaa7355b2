#include "shifted_clock.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/identify.h"
#include "knee_robot/identification/prior.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::identification {
namespace {

constexpr double kShifts_s[] = {0.125, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
constexpr double kNearTheBestShift[] = {0.8, 0.85, 0.9, 0.95, 1.05, 1.1, 1.15, 1.2};
constexpr double kMuchBetterShifted = 0.5;  ///< of the error
constexpr double kUsualError = 0.05;        ///< what a good fit leaves, as weight of the equations against the prior
constexpr double kNarrowStop_counts = 2.0;  ///< encoder counts, as IdentifyOptions

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

/// The equations of every actuator beside its force, taken at several times.
class Shifts {
 public:
  /// Coulomb columns are those of narrow stops: the laws near rest were chosen for the recording as it is.
  Shifts(const mechanism::Robot& robot, const std::vector<Column>& columns, std::vector<Observation> training,
         const ObservationOptions& options)
      : columns_(columns), axes_(robot.axes()), training_(std::move(training)), options_(options) {
    std::vector<dynamics::FrictionLaw> laws;
    for (const double width : narrowestWidths(robot, kNarrowStop_counts))
      laws.push_back(dynamics::stopLaw(width));
    for (Observation& o : training_)
      setFriction(o, columns, laws);
    equations_ = stackEquations(training_, options);
    const Eigen::VectorXd force_rms = rmsPerActuator(equations_, equations_.b).array().max(1e-9);
    prior_ = priorOf(robot, columns, force_rms);
    const Eigen::Index each = equations_.rows() / axes_;
    const Eigen::MatrixXd forces = equations_.b.reshaped(each, axes_);
    spread_ = (forces.rowwise() - forces.colwise().mean()).colwise().norm().transpose() / std::sqrt(each);
    spread_ = spread_.array().max(1e-9);
  }

  /// rms error over the spread of the force, per actuator and time.
  Eigen::MatrixXd errorsOf(const std::vector<double>& later_s) const {
    const Eigen::Index n = static_cast<Eigen::Index>(columns_.size()),
                       times = static_cast<Eigen::Index>(later_s.size());
    const Eigen::Index each = equations_.rows() / axes_;
    std::vector<Eigen::MatrixXd> blocks;
    for (int i = 0; i < axes_; ++i) {
      std::vector<Eigen::MatrixXd> forces;
      for (const Observation& o : training_) {
        forces.emplace_back(o.samples(), times);
        for (Eigen::Index k = 0; k < times; ++k)
          forces.back().col(k) =
              takenLater(o.signals.force_N.col(i), later_s[static_cast<std::size_t>(k)], o.signals.period_s);
      }
      const Eigen::MatrixXd at_rows = atRows(training_, options_, equations_, i, std::move(forces));
      Eigen::MatrixXd both(each, n + times - 1);
      both << equations_.a.middleRows(i * each, each), at_rows.leftCols(times - 1);
      blocks.push_back(compress(both, at_rows.col(times - 1)) / (kUsualError * spread_[i]));
    }
    Eigen::MatrixXd errors(axes_, times);
    for (Eigen::Index k = 0; k < times; ++k)
      errors.col(k) = errorOf(blocks, n + k, each);
    return errors;
  }

 private:
  Eigen::VectorXd errorOf(const std::vector<Eigen::MatrixXd>& blocks, Eigen::Index force, Eigen::Index rows) const {
    const Eigen::Index n = static_cast<Eigen::Index>(columns_.size());
    std::vector<Eigen::MatrixXd> these;
    for (const Eigen::MatrixXd& block : blocks) {
      these.emplace_back(block.rows(), n + 1);
      these.back() << block.leftCols(n), block.col(force);
    }
    const Reduction reduction = reduce(joinBlocks(these, -1), columns_, std::vector<char>(columns_.size(), 1), prior_);
    const Eigen::VectorXd parameters = toParameters(reduction, solveWithPrior(reduction, reduction.maximalRank(), 1.0));
    Eigen::VectorXd error(axes_);
    for (int i = 0; i < axes_; ++i) {
      const Eigen::MatrixXd& block = these[static_cast<std::size_t>(i)];
      error[i] = kUsualError * (block.leftCols(n) * parameters - block.col(n)).norm() / std::sqrt(rows);
    }
    return error;
  }

  const std::vector<Column>& columns_;
  int axes_;
  std::vector<Observation> training_;
  const ObservationOptions& options_;
  Equations equations_;
  Prior prior_;
  Eigen::VectorXd spread_;  ///< rms of every force about its mean
};

Eigen::Index columnOfLeast(const Eigen::MatrixXd& errors) {
  Eigen::Index least = 0;
  errors.colwise().squaredNorm().minCoeff(&least);
  return least;
}

}  // namespace

std::string doubtAboutClocks(const mechanism::Robot& robot, const std::vector<Column>& columns,
                             std::vector<Observation> training, const ObservationOptions& options) {
  const Shifts shifts(robot, columns, std::move(training), options);
  const Eigen::VectorXd as_recorded = shifts.errorsOf({0.0});
  std::vector<double> tried;
  for (const double shift : kShifts_s)
    tried.insert(tried.end(), {shift, -shift});
  double best_s = tried[static_cast<std::size_t>(columnOfLeast(shifts.errorsOf(tried)))];
  std::vector<double> near = {best_s};
  for (const double factor : kNearTheBestShift)
    near.push_back(factor * best_s);
  const Eigen::MatrixXd errors = shifts.errorsOf(near);
  const Eigen::Index best = columnOfLeast(errors);
  best_s = near[static_cast<std::size_t>(best)];
  if (errors.col(best).norm() > kMuchBetterShifted * as_recorded.norm()) return "";
  Eigen::Index worst = 0;
  as_recorded.maxCoeff(&worst);
  const auto percent = [](double share) { return shortNumber(100.0 * share, 2) + " %"; };
  return "With the forces recorded " + shortNumber(std::abs(best_s), 2) + " s " + (best_s > 0.0 ? "later" : "before") +
         " the positions the model leaves " + percent(errors(worst, best)) +
         " of what varies in the force of actuator " + std::to_string(worst + 1) + ", with those of the same time " +
         percent(as_recorded[worst]) +
         ": were forces and positions stamped by different clocks, or forces stamped when they arrived?";
}

}  // namespace knee_robot::identification
