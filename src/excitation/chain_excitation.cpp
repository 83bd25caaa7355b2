#include "knee_robot/excitation/chain_excitation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlopt.hpp>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/chain_regressor.h"

namespace knee_robot::excitation {
namespace {

constexpr double kStep_s = trajectory::kStreamPeriod;  ///< of the motion that is written, and of the search's
constexpr double kLook_s = 0.001;                      ///< at which the limits of what is written are looked at
constexpr int kInstants = 60;                          ///< at which information is counted during the search
constexpr double kDrySpeed = 0.02;                     ///< of the velocity limit: dry friction is full
constexpr double kOwnUnit = 10.0;                      ///< noises of a unit of friction or offset
constexpr int kOwn = 3;                                ///< columns of every joint's own
constexpr double kStepShare = 1e-3;
constexpr int kMostCandidates = 100000;

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

/// What a series of one joint comes to, before it is scaled to the limits.
struct Extent {
  double low = 0.0, high = 0.0, rate = 0.0, acceleration = 0.0;

  void take(double q, double v, double a) {
    low = std::min(low, q);
    high = std::max(high, q);
    rate = std::max(rate, std::abs(v));
    acceleration = std::max(acceleration, std::abs(a));
  }
};

/// Factor and shift of a joint's series that keep its limits.
struct Placing {
  double scale, shift;
};

/// `centre`: -1 to 1, within what the range leaves.
Placing placingOf(const Extent& e, const Limits& limits, double centre) {
  const double scale =
      std::min({(limits.high - limits.low) / std::max(1e-12, e.high - e.low), limits.velocity / std::max(1e-12, e.rate),
                limits.acceleration / std::max(1e-12, e.acceleration)});
  const double first = limits.low - scale * e.low, last = limits.high - scale * e.high;
  return {scale, first + 0.5 * (1.0 + centre) * (last - first)};
}

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

  /// Scaled by what is seen on the written grid.
  Motion motionOf(const std::vector<double>& x) const { return placed(x, nullptr); }

  /// Scaled by what is seen at every kLook_s, ramps and ends included; `use`: what it then comes to.
  Motion finalMotionOf(const std::vector<double>& x, std::vector<JointUse>& use) const {
    const std::vector<Extent> extents = finely(x);
    const Motion m = placed(x, &extents);
    use.clear();
    for (int i = 0; i < robot_.axes(); ++i)
      use.push_back(useOf(x, i, extents[static_cast<std::size_t>(i)]));
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
    return worth(motionOf(x));
  }
  double worth(const Motion& m) const { return logDeterminant(informationOf(m, kInstants)); }

  const Eigen::MatrixXd& known() const { return known_; }
  int evaluations = 0;

 private:
  static constexpr double kRowsPerSecond = 6.0;

  const mechanism::Actuator& joint(int i) const { return robot_.actuators[static_cast<std::size_t>(i)]; }
  Eigen::Map<const Eigen::VectorXd> coefficients(const std::vector<double>& x, int i) const {
    return {x.data() + static_cast<Eigen::Index>(i) * (columns_ + 1), columns_};
  }
  Placing placing(const std::vector<double>& x, int i, const Extent& extent) const {
    return placingOf(extent, limitsOf(joint(i), options_.share),
                     x[static_cast<std::size_t>((i + 1) * (columns_ + 1) - 1)]);
  }

  Motion placed(const std::vector<double>& x, const std::vector<Extent>* extents) const {
    const Eigen::Index n = grid_.value.rows();
    Motion m{Eigen::MatrixXd(n, robot_.axes()), Eigen::MatrixXd(n, robot_.axes()), Eigen::MatrixXd(n, robot_.axes())};
    for (int i = 0; i < robot_.axes(); ++i) {
      const auto c = coefficients(x, i);
      const Eigen::VectorXd q = grid_.value * c, v = grid_.rate * c, a = grid_.acceleration * c;
      const Extent seen{q.minCoeff(), q.maxCoeff(), v.cwiseAbs().maxCoeff(), a.cwiseAbs().maxCoeff()};
      const Placing place = placing(x, i, extents != nullptr ? (*extents)[static_cast<std::size_t>(i)] : seen);
      m.q.col(i) = (place.scale * q).array() + place.shift;
      m.v.col(i) = place.scale * v;
      m.a.col(i) = place.scale * a;
    }
    return m;
  }

  std::vector<Extent> finely(const std::vector<double>& x) const {
    std::vector<Extent> extents(static_cast<std::size_t>(robot_.axes()));
    const long last = std::lround(options_.shape.duration_s / kLook_s);
    for (long k = 0; k <= last; ++k) {
      const SeriesBasis basis = seriesBasis(options_.shape, kLook_s * static_cast<double>(k));
      for (int i = 0; i < robot_.axes(); ++i) {
        const auto c = coefficients(x, i);
        extents[static_cast<std::size_t>(i)].take(basis.value * c, basis.rate * c, basis.acceleration * c);
      }
    }
    return extents;
  }

  JointUse useOf(const std::vector<double>& x, int i, const Extent& extent) const {
    const Limits whole = limitsOf(joint(i), 1.0);
    const Placing place = placing(x, i, extent);
    JointUse use;
    use.name = joint(i).name;
    use.low = place.shift + place.scale * extent.low;
    use.high = place.shift + place.scale * extent.high;
    const double middle = 0.5 * (whole.low + whole.high);
    use.range = std::max(use.high - middle, middle - use.low) / (whole.high - middle);
    use.velocity = place.scale * extent.rate / whole.velocity;
    use.acceleration = place.scale * extent.acceleration / whole.acceleration;
    return use;
  }

  const mechanism::Robot& robot_;
  const ChainExcitationOptions& options_;
  Grid grid_;
  Eigen::Index columns_;
  Eigen::MatrixXd known_;
};

class Budget {
 public:
  explicit Budget(double seconds) : seconds_(seconds) {}
  double left() const {
    return seconds_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  double seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// One at least, whatever the budget.
std::vector<double> bestRandom(Search& search, const ChainExcitationOptions& options, const Budget& budget) {
  std::mt19937 dice(options.seed);
  const auto uniform = [&] { return 2.0 * static_cast<double>(dice()) / 4294967296.0 - 1.0; };
  std::vector<double> x(static_cast<std::size_t>(search.size())), chosen;
  double best = 0.0;
  for (int k = 0; k < options.candidates && (k == 0 || budget.left() > 0.0); ++k) {
    for (double& value : x)
      value = uniform();
    const double now = search.value(x);
    if (!chosen.empty() && now <= best) continue;
    best = now;
    chosen = x;
  }
  return chosen;
}

void climbFrom(Search& search, const Budget& budget, std::vector<double>& x) {
  const double left = budget.left();
  if (left <= 0.0) return;  // NLopt would take it for no limit
  nlopt::opt climb(nlopt::LN_SBPLX, static_cast<unsigned>(x.size()));
  climb.set_lower_bounds(-1.0);
  climb.set_upper_bounds(1.0);
  climb.set_initial_step(0.3);
  climb.set_ftol_rel(kStepShare);
  climb.set_maxtime(left);
  climb.set_max_objective([](const std::vector<double>& at, std::vector<double>&,
                             void* data) { return static_cast<Search*>(data)->value(at); },
                          &search);
  double best = 0.0;
  climb.optimize(x, best);
}

int decided(const Eigen::MatrixXd& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information, Eigen::EigenvaluesOnly);
  return static_cast<int>((eigen.eigenvalues().array() > 2.0).count());  // the prior's own is 1
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

ChainExcitationPlan planChainExcitation(const mechanism::Robot& robot, const ChainExcitationOptions& given) {
  ChainExcitationOptions options = given;
  options.shape = completedShape(given.shape);
  if (!(options.share > 0.0 && options.share <= 1.0)) throw InputError("the share of the limits must be within 0 to 1");
  if (options.candidates < 1 || options.candidates > kMostCandidates)
    throw InputError("candidates are not in 1 to " + std::to_string(kMostCandidates));
  if (!(options.seconds_budget > 0.0)) throw InputError("the time limit of planning must be positive");
  const Budget budget(options.seconds_budget);
  Search search(robot, options);
  ChainExcitationPlan plan;
  const std::vector<double> random = bestRandom(search, options, budget);
  std::vector<double> x = random;
  climbFrom(search, budget, x);
  const Motion m = search.finalMotionOf(x, plan.joints);
  plan.period_s = kStep_s;
  plan.position = m.q;
  plan.velocity = m.v;
  plan.information = search.worth(m);
  std::vector<JointUse> unused;
  plan.information_random = x == random ? plan.information : search.worth(search.finalMotionOf(random, unused));
  plan.information_known = Search::logDeterminant(search.known());
  plan.decided_known = decided(search.known());
  plan.decided = decided(search.informationOf(m, kInstants));
  plan.evaluations = search.evaluations;
  return plan;
}

}  // namespace knee_robot::excitation
