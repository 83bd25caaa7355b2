#include "knee_robot/excitation/chain_excitation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nlopt.hpp>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/chain_regressor.h"

namespace knee_robot::excitation {
namespace {

constexpr double kStep_s = 0.01;    ///< of the motion that is written, and on which limits are looked at
constexpr int kInstants = 60;       ///< at which information is counted during the search
constexpr double kDrySpeed = 0.02;  ///< of the velocity limit: dry friction is full
constexpr double kOwnUnit = 10.0;   ///< noises of a unit of friction or offset
constexpr int kOwn = 3;             ///< columns of every joint's own
constexpr double kStepShare = 1e-3;

/// Limits of one joint in its own unit.
struct Limits {
  double low, high, velocity, acceleration;
};

Limits limitsOf(const mechanism::Actuator& a, double share) {
  const double unit = a.position_per_m();
  const double middle = 0.5 * (a.position_min_m + a.position_max_m) * unit;
  const double half = 0.5 * share * (a.position_max_m - a.position_min_m) * unit;
  return {middle - half, middle + half, share * a.velocity_max_m_per_s * unit,
          share * a.acceleration_max_m_per_s2 * unit};
}

/// Basis at every written instant.
struct Grid {
  Eigen::MatrixXd value, rate, acceleration;

  explicit Grid(const SeriesShape& shape) {
    const Eigen::Index count = static_cast<Eigen::Index>(std::llround(shape.duration_s / kStep_s)) + 1;
    value.resize(count, coefficientColumns(shape));
    rate = acceleration = value;
    for (Eigen::Index n = 0; n < count; ++n) {
      const SeriesBasis basis = seriesBasis(shape, kStep_s * static_cast<double>(n));
      value.row(n) = basis.value;
      rate.row(n) = basis.rate;
      acceleration.row(n) = basis.acceleration;
    }
  }
};

struct Motion {
  Eigen::MatrixXd q, v, a;
};

/// The search's problem: a vector of coefficients (joint by joint) and centres becomes a motion within all limits.
class Search {
 public:
  Search(const mechanism::Robot& robot, const ChainExcitationOptions& options)
      : robot_(robot), options_(options), grid_(options.shape), columns_(coefficientColumns(options.shape)) {
    const Eigen::Index size = options.units.cols() + kOwn * robot.axes();
    known_ = Eigen::MatrixXd::Identity(size, size);
    if (options.known.size() > 0) known_ += options.known;
  }

  int size() const { return robot_.axes() * static_cast<int>(columns_ + 1); }

  Motion motionOf(const std::vector<double>& x) const {
    const Eigen::Index n = grid_.value.rows();
    Motion m{Eigen::MatrixXd(n, robot_.axes()), Eigen::MatrixXd(n, robot_.axes()), Eigen::MatrixXd(n, robot_.axes())};
    for (int i = 0; i < robot_.axes(); ++i) {
      const double* const own = x.data() + static_cast<Eigen::Index>(i) * (columns_ + 1);
      const Eigen::Map<const Eigen::VectorXd> c(own, columns_);
      const Limits limits = limitsOf(robot_.actuators[static_cast<std::size_t>(i)], options_.share);
      Eigen::VectorXd q = grid_.value * c, v = grid_.rate * c, a = grid_.acceleration * c;
      const double low = q.minCoeff(), high = q.maxCoeff();
      const double scale = std::min({(limits.high - limits.low) / std::max(1e-12, high - low),
                                     limits.velocity / std::max(1e-12, v.cwiseAbs().maxCoeff()),
                                     limits.acceleration / std::max(1e-12, a.cwiseAbs().maxCoeff())});
      const double first = limits.low - scale * low, last = limits.high - scale * high;
      m.q.col(i) = (scale * q).array() + first + 0.5 * (1.0 + own[columns_]) * (last - first);
      m.v.col(i) = scale * v;
      m.a.col(i) = scale * a;
    }
    return m;
  }

  Eigen::MatrixXd informationOf(const Motion& m, Eigen::Index instants) const {
    std::vector<Eigen::Index> at;
    for (Eigen::Index k = 0; k < instants; ++k)
      at.push_back((2 * k + 1) * m.q.rows() / (2 * instants));
    const Eigen::MatrixXd rows =
        chainInformation(robot_, options_, m.q(at, Eigen::all), m.v(at, Eigen::all), m.a(at, Eigen::all));
    // As many independent rows as the cut-off of identification leaves: a few a second.
    const double weight = options_.shape.duration_s * kRowsPerSecond / static_cast<double>(instants);
    return known_ + weight * rows.transpose() * rows;
  }

  static double logDeterminant(const Eigen::MatrixXd& information) {
    return 2.0 * Eigen::MatrixXd(information.llt().matrixL()).diagonal().array().log().sum();
  }

  double value(const std::vector<double>& x) {
    ++evaluations;
    return logDeterminant(informationOf(motionOf(x), kInstants));
  }

  const Eigen::MatrixXd& known() const { return known_; }
  int evaluations = 0;

 private:
  static constexpr double kRowsPerSecond = 6.0;
  const mechanism::Robot& robot_;
  const ChainExcitationOptions& options_;
  Grid grid_;
  Eigen::Index columns_;
  Eigen::MatrixXd known_;
};

std::vector<double> bestRandom(Search& search, const ChainExcitationOptions& options, double& best) {
  std::mt19937 dice(options.seed);
  const auto uniform = [&] { return 2.0 * static_cast<double>(dice()) / 4294967296.0 - 1.0; };
  std::vector<double> x(static_cast<std::size_t>(search.size())), chosen;
  for (int k = 0; k < options.candidates; ++k) {
    for (double& value : x)
      value = uniform();
    const double now = search.value(x);
    if (!chosen.empty() && now <= best) continue;
    best = now;
    chosen = x;
  }
  return chosen;
}

int decided(const Eigen::MatrixXd& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information, Eigen::EigenvaluesOnly);
  return static_cast<int>((eigen.eigenvalues().array() > 2.0).count());  // the prior's own is 1
}

std::vector<JointUse> useOf(const mechanism::Robot& robot, const Motion& m) {
  std::vector<JointUse> all;
  for (int i = 0; i < robot.axes(); ++i) {
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    const Limits whole = limitsOf(a, 1.0);
    JointUse use;
    use.name = a.name;
    use.low = m.q.col(i).minCoeff();
    use.high = m.q.col(i).maxCoeff();
    const double middle = 0.5 * (whole.low + whole.high);
    use.range = std::max(use.high - middle, middle - use.low) / (whole.high - middle);
    use.velocity = m.v.col(i).cwiseAbs().maxCoeff() / whole.velocity;
    use.acceleration = m.a.col(i).cwiseAbs().maxCoeff() / whole.acceleration;
    all.push_back(use);
  }
  return all;
}

}  // namespace

Eigen::MatrixXd chainInformation(const mechanism::Robot& robot, const ChainExcitationOptions& options,
                                 const Eigen::MatrixXd& q, const Eigen::MatrixXd& v, const Eigen::MatrixXd& a) {
  const Eigen::Index n = robot.axes(), bodies = options.units.cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(q.rows() * n, bodies + kOwn * n);
  dynamics::ChainRegressorData data(*robot.chain);
  for (Eigen::Index k = 0; k < q.rows(); ++k) {
    dynamics::chainRegressor(*robot.chain, robot.gravity, q.row(k).transpose(), v.row(k).transpose(),
                             a.row(k).transpose(), data);
    for (Eigen::Index i = 0; i < n; ++i) {
      auto row = rows.row(k * n + i);
      row.head(bodies) = data.regressor.row(i) * options.units / options.noise[i];
      const mechanism::Actuator& joint = robot.actuators[static_cast<std::size_t>(i)];
      const double fastest = joint.velocity_max_m_per_s * joint.position_per_m();
      row.segment(bodies + kOwn * i, kOwn) << v(k, i) / fastest, std::tanh(v(k, i) / (kDrySpeed * fastest)), 1.0;
      row.segment(bodies + kOwn * i, kOwn) *= kOwnUnit;
    }
  }
  return rows;
}

ChainExcitationPlan planChainExcitation(const mechanism::Robot& robot, const ChainExcitationOptions& options) {
  if (!(options.share > 0.0 && options.share <= 1.0)) throw InputError("the share of the limits must be within 0 to 1");
  if (options.shape.harmonics < 1 || options.candidates < 1)
    throw InputError("harmonics and candidates must be positive");
  Search search(robot, options);
  ChainExcitationPlan plan;
  std::vector<double> x = bestRandom(search, options, plan.information_random);
  nlopt::opt climb(nlopt::LN_SBPLX, static_cast<unsigned>(x.size()));
  climb.set_lower_bounds(-1.0);
  climb.set_upper_bounds(1.0);
  climb.set_initial_step(0.3);
  climb.set_ftol_rel(kStepShare);
  climb.set_maxtime(options.seconds_budget);
  climb.set_max_objective([](const std::vector<double>& at, std::vector<double>&,
                             void* data) { return static_cast<Search*>(data)->value(at); },
                          &search);
  double best = 0.0;
  climb.optimize(x, best);
  const Motion m = search.motionOf(x);
  plan.period_s = kStep_s;
  plan.position = m.q;
  plan.velocity = m.v;
  plan.joints = useOf(robot, m);
  plan.information = best;
  plan.information_known = Search::logDeterminant(search.known());
  plan.decided_known = decided(search.known());
  plan.decided = decided(search.informationOf(m, kInstants));
  plan.evaluations = search.evaluations;
  return plan;
}

}  // namespace knee_robot::excitation
