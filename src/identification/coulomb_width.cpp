#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "knee_robot/identification/identify.h"
#include "knee_robot/recording/filter.h"

namespace knee_robot::identification {
namespace {

constexpr double kWidest_m = 1e-3;  ///< beyond this it would be a spring, not a friction step

/// Usable samples of all training recordings, low-passed: the actuator's residual without its own friction, and
/// [viscous, offset] to which the Coulomb share is joined.
struct OwnEquations {
  Eigen::MatrixXd design;
  Eigen::VectorXd target;
};

Eigen::VectorXd lowPassed(const Observation& o, Eigen::VectorXd signal, const ObservationOptions& options) {
  recording::ZeroPhaseLowPass(options.cutoff_hz, 1.0 / o.signals.period_s).apply(signal);
  return signal;
}

Eigen::VectorXd usableOf(const std::vector<Observation>& training, const std::vector<Eigen::VectorXd>& signals) {
  std::vector<double> out;
  for (std::size_t f = 0; f < training.size(); ++f) {
    for (int n = 0; n < training[f].samples(); ++n) {
      if (training[f].usable[static_cast<std::size_t>(n)]) out.push_back(signals[f][n]);
    }
  }
  return Eigen::Map<Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

OwnEquations ownEquations(const std::vector<Observation>& training, const std::vector<Column>& columns,
                          const Eigen::VectorXd& parameters, int actuator, const ObservationOptions& options) {
  Eigen::VectorXd others = parameters;  // everything but the actuator's own friction
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool own = columns[c].actuator == actuator &&
                     (columns[c].role == ColumnRole::Coulomb || columns[c].role == ColumnRole::Viscous);
    if (own) others[static_cast<Eigen::Index>(c)] = 0.0;
  }
  std::vector<Eigen::VectorXd> rest, velocity;
  for (const Observation& o : training) {
    const Eigen::VectorXd explained = o.regressor[static_cast<std::size_t>(actuator)] * others;
    rest.push_back(o.force_filtered_N.col(actuator) - lowPassed(o, explained, options));
    velocity.push_back(lowPassed(o, o.signals.velocity_m_per_s.col(actuator), options));
  }
  OwnEquations e;
  e.target = usableOf(training, rest);
  e.design.resize(e.target.size(), 3);
  e.design.col(0) = usableOf(training, velocity);
  e.design.col(1).setOnes();
  return e;
}

}  // namespace

std::vector<double> narrowestCoulombWidths(const mechanism::Robot& robot, double counts) {
  std::vector<double> widths;
  for (const mechanism::Actuator& a : robot.actuators)
    widths.push_back(std::min(kWidest_m, counts * a.metresPerCount()));
  return widths;
}

std::vector<double> chooseCoulombWidths(const mechanism::Robot& robot, const std::vector<Column>& columns,
                                        const std::vector<Observation>& training, const Eigen::VectorXd& parameters,
                                        const IdentifyOptions& all_options) {
  const ObservationOptions& options = all_options.observation;
  std::vector<double> widths = narrowestCoulombWidths(robot, all_options.narrowest_counts);
  for (int i = 0; i < robot.axes(); ++i) {
    OwnEquations e = ownEquations(training, columns, parameters, i, options);
    double least = std::numeric_limits<double>::infinity();
    for (double width = widths[static_cast<std::size_t>(i)]; width <= kWidest_m; width *= std::sqrt(2.0)) {
      std::vector<Eigen::VectorXd> share;
      for (const Observation& o : training)
        share.push_back(lowPassed(o, frictionShare(o.sliding[static_cast<std::size_t>(i)], width), options));
      e.design.col(2) = usableOf(training, share);
      const Eigen::VectorXd own = (e.design.transpose() * e.design).ldlt().solve(e.design.transpose() * e.target);
      const double left = (e.target - e.design * own).squaredNorm();
      if (left >= least) continue;
      least = left;
      widths[static_cast<std::size_t>(i)] = width;
    }
  }
  return widths;
}

}  // namespace knee_robot::identification
