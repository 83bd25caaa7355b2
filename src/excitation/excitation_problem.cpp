#include "excitation_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace knee_robot::excitation {
namespace {

constexpr double kSamplesPerPeriod = 20.0;  ///< of the highest harmonic
constexpr double kLeastHertz = 10.0;
constexpr int kFiner = 3;                 ///< times as many instants where a series is judged, not improved
constexpr double kTranslationUnit = 0.1;  ///< m of pose that one unit of a variable moves
constexpr double kRotationUnit = 0.3;     ///< rad
constexpr int kCentreRounds = 6;  ///< of halving a centre's distance from the middle until it is within the limits
constexpr double kLeastFactor = 1e-3;
constexpr double kFirstLess = 5e-4;  ///< of the largest factor, when that does not fit; then twice as much, ...
/// Places of the quantities among the uses of an instant.
constexpr int kLength = 0, kVelocity = 4, kAcceleration = 8, kForce = 12, kBase = 16, kTip = 20, kCondition = 23;

double topHertz(const SeriesShape& shape) {
  return shape.harmonics / shape.period_s;
}

double sign(double x) {
  return x < 0.0 ? -1.0 : 1.0;
}

}  // namespace

SampledBasis::SampledBasis(const SeriesShape& shape, double rate_hz) {
  const long last = std::lround(shape.duration_s * rate_hz);
  for (long k = 0; k <= last; ++k)
    at.push_back(seriesBasis(shape, static_cast<double>(k) * shape.duration_s / static_cast<double>(last)));
}

ExcitationProblem::ExcitationProblem(ExcitationTask task, const mechanism::Pose& centre)
    : task_(std::move(task)),
      centre_lengths_(mechanism::legLengths(*task_.robot.mechanism, centre)),
      centre_pose_(centre),
      unit_(mechanism::lengthJacobian(*task_.robot.mechanism, centre) *
            mechanism::Vector4(kTranslationUnit, kTranslationUnit, kRotationUnit, kRotationUnit).asDiagonal()),
      basis_(task_.shape, std::max(kLeastHertz, kSamplesPerPeriod * topHertz(task_.shape))),
      fine_(task_.shape, kFiner * std::max(kLeastHertz, kSamplesPerPeriod * topHertz(task_.shape))),
      stretches_(std::max(1, static_cast<int>(std::ceil(4.0 * topHertz(task_.shape) * task_.shape.duration_s)))) {
  for (int i = 0; i < mechanism::kLegs; ++i) {
    peak_force_[i] = task_.robot.actuators[i].forceLimit();
    const double continuous = task_.robot.actuators[i].force_continuous_N;
    rms_force_[i] = continuous > 0.0 ? continuous : std::numeric_limits<double>::infinity();
  }
  const mechanism::JointLimits& joints = task_.robot.joints;
  cosine_room_ = {1.0 - std::cos(joints.spherical_max), 1.0 - std::cos(joints.universal_max),
                  1.0 - std::cos(joints.revolute_max)};
  log_condition_max_ = std::log(task_.robot.singularity_condition_max);
  if (!task_.twin_legs) return;
  unit_.row(1) = 0.5 * (unit_.row(1) + unit_.row(2)).eval();
  unit_.row(2) = unit_.row(1);
  centre_lengths_[1] = 0.5 * (centre_lengths_[1] + centre_lengths_[2]);
  centre_lengths_[2] = centre_lengths_[1];
}

FourierSeries ExcitationProblem::series(const Eigen::VectorXd& variables) const {
  FourierSeries series;
  series.shape = task_.shape;
  series.space = trajectory::Space::Actuator;
  series.centre = centre_lengths_ + unit_ * variables.head<4>();
  series.coefficients = unit_ * Eigen::Map<const Eigen::Matrix<double, 4, Eigen::Dynamic>>(
                                    variables.data() + 4, 4, coefficientColumns(task_.shape));
  return series;
}

mechanism::Pose ExcitationProblem::startPose(const FourierSeries& series, bool& ok) const {
  const mechanism::ForwardResult start =
      mechanism::forwardKinematics(*task_.robot.mechanism, series.centre, centre_pose_);
  ok = start.ok();
  return start.pose;
}

bool ExcitationProblem::visit(const SeriesPoint& point, const mechanism::Pose& guess,
                              const dynamics::CoulombWidth& width, Instant& out) const {
  static thread_local dynamics::RegressorData data;
  const mechanism::Mechanism& mechanism = *task_.robot.mechanism;
  out.point = point;
  if (mechanism::motionFromLengths(mechanism, point.value, point.rate, point.acceleration, guess, out.motion) !=
      mechanism::ForwardStatus::Converged) {
    return false;
  }
  if (!dynamics::projectedRegressor(mechanism, task_.robot.gravity, out.motion, data, width)) return false;
  out.regressor = data.k;
  if (task_.load) out.force = data.k * task_.load->parameters + task_.load->rotor_mass.cwiseProduct(point.acceleration);
  return true;
}

void ExcitationProblem::fillUses(Instant& instant) const {
  const mechanism::Robot& robot = task_.robot;
  const SeriesPoint& point = instant.point;
  const mechanism::JointAngles angles = mechanism::jointAngles(*robot.mechanism, instant.motion.pose);
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::Actuator& actuator = robot.actuators[i];
    const double middle = 0.5 * (actuator.position_min_m + actuator.position_max_m);
    instant.uses[kLength + i] = std::abs(point.value[i] - middle) / (actuator.position_max_m - middle);
    instant.uses[kVelocity + i] = std::abs(point.rate[i]) / actuator.velocity_max_m_per_s;
    instant.uses[kAcceleration + i] = std::abs(point.acceleration[i]) / actuator.acceleration_max_m_per_s2;
    instant.uses[kForce + i] = std::abs(instant.force[i]) / peak_force_[i];
    const double base_room = i < 3 ? cosine_room_.universal_max : cosine_room_.revolute_max;
    instant.uses[kBase + i] = (1.0 - std::cos(angles.base[i])) / base_room;
    if (i < 3) instant.uses[kTip + i] = (1.0 - std::cos(angles.platform[i])) / cosine_room_.spherical_max;
  }
  instant.uses[kCondition] =
      std::log(mechanism::conditionNumber(*robot.mechanism, instant.motion.pose)) / log_condition_max_;
}

void ExcitationProblem::slopesOfUses(const Instant& instant, const InstantSlopes& slopes, UseSlopes& out) const {
  const mechanism::Robot& robot = task_.robot;
  out.setZero();
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::Actuator& actuator = robot.actuators[i];
    const double middle = 0.5 * (actuator.position_min_m + actuator.position_max_m);
    out(kLength + i, i) = sign(instant.point.value[i] - middle) / (actuator.position_max_m - middle);
    out(kVelocity + i, mechanism::kLegs + i) = sign(instant.point.rate[i]) / actuator.velocity_max_m_per_s;
    out(kAcceleration + i, 2 * mechanism::kLegs + i) =
        sign(instant.point.acceleration[i]) / actuator.acceleration_max_m_per_s2;
    out.row(kForce + i) = sign(instant.force[i]) / peak_force_[i] * slopes.slope.row(slope_row::kForce + i);
    const double base_room = i < 3 ? cosine_room_.universal_max : cosine_room_.revolute_max;
    out.row(kBase + i) = -slopes.slope.row(slope_row::kBaseCosine + i) / base_room;
    if (i < 3) out.row(kTip + i) = -slopes.slope.row(slope_row::kTipCosine + i) / cosine_room_.spherical_max;
  }
  out.row(kCondition) = slopes.slope.row(slope_row::kCondition) / log_condition_max_;
}

int ExcitationProblem::stretchOf(std::size_t instant) const {
  return static_cast<int>(instant * static_cast<std::size_t>(stretches_) / basis_.at.size());
}

void ExcitationProblem::addSlopes(const std::vector<Instant>& instants, const SpectralCost& cost,
                                  Evaluation& out) const {
  const Eigen::Index columns = coefficientColumns(task_.shape);
  using ByActuator = Eigen::Matrix<double, mechanism::kLegs, Eigen::Dynamic>;  // centre, then coefficients
  ByActuator by_cost = ByActuator::Zero(mechanism::kLegs, 1 + columns);
  const auto add = [&](const Eigen::Matrix<double, 1, 3 * mechanism::kLegs>& slope, const SeriesBasis& basis,
                       ByActuator& sum) {
    sum.col(0) += slope.head<4>().transpose();
    sum.rightCols(columns).noalias() += slope.head<4>().transpose() * basis.value +
                                        slope.segment<4>(4).transpose() * basis.rate +
                                        slope.tail<4>().transpose() * basis.acceleration;
  };
  const auto asVariables = [&](const ByActuator& sum) -> Eigen::VectorXd {
    const Eigen::MatrixXd product = unit_.transpose() * sum;
    return Eigen::Map<const Eigen::VectorXd>(product.data(), product.size());
  };
  std::vector<std::pair<int, std::size_t>> chosen(static_cast<std::size_t>(kQuantities * stretches_), {-1, 0});
  for (std::size_t t = 0; t < instants.size(); ++t) {
    for (int q = 0; q < kQuantities; ++q) {
      const std::size_t place = static_cast<std::size_t>(stretchOf(t) * kQuantities + q);
      if (chosen[place].first < 0 || instants[t].uses[q] > instants[chosen[place].second].uses[q])
        chosen[place] = {q, t};
    }
  }
  out.limit_gradients.setZero(variables(), limits());
  std::array<ByActuator, mechanism::kLegs> by_rms;
  by_rms.fill(ByActuator::Zero(mechanism::kLegs, 1 + columns));
  const mechanism::Vector4 weight = task_.noise_N.cwiseInverse();
  for (std::size_t t = 0; t < instants.size(); ++t) {
    const Instant& instant = instants[t];
    const PaperRegressor weights = weight.asDiagonal() * cost.gradient(weight.asDiagonal() * instant.regressor);
    const InstantSlopes slopes = instantSlopes(*task_.robot.mechanism, task_.robot.gravity, instant.motion, task_.width,
                                               instant.regressor, weights, task_.load.value_or(ExpectedLoad{}));
    add(slopes.slope.row(slope_row::kObservation), basis_.at[t], by_cost);
    UseSlopes use_slopes;
    slopesOfUses(instant, slopes, use_slopes);
    for (int q = 0; q < kQuantities; ++q) {
      const int place = stretchOf(t) * kQuantities + q;
      if (chosen[static_cast<std::size_t>(place)].second != t) continue;
      ByActuator sum = ByActuator::Zero(mechanism::kLegs, 1 + columns);
      add(use_slopes.row(q), basis_.at[t], sum);
      out.limit_gradients.col(place) = asVariables(sum);
    }
    for (int i = 0; task_.load && i < mechanism::kLegs; ++i) {
      add(2.0 * instant.force[i] * slopes.slope.row(slope_row::kForce + i), basis_.at[t],
          by_rms[static_cast<std::size_t>(i)]);
    }
  }
  out.cost_gradient = asVariables(by_cost);
  const double count = static_cast<double>(instants.size());
  for (int i = 0; i < mechanism::kLegs; ++i) {
    out.limit_gradients.col(kQuantities * stretches_ + i) =
        asVariables(by_rms[static_cast<std::size_t>(i)]) / (count * rms_force_[i] * rms_force_[i]);
  }
  out.has_slopes = true;
}

bool ExcitationProblem::evaluate(const Eigen::VectorXd& variables, double exponent, bool with_slopes,
                                 Evaluation& out) const {
  const FourierSeries series = this->series(variables);
  bool ok = false;
  mechanism::Pose pose = startPose(series, ok);
  std::vector<Instant> instants(basis_.at.size());
  std::vector<PaperRegressor> observations;
  observations.reserve(instants.size());
  const mechanism::Vector4 weight = task_.noise_N.cwiseInverse();
  out.variables = variables;
  out.has_slopes = false;
  out.limits = Eigen::VectorXd::Constant(limits(), -1.0);
  mechanism::Vector4 squares = mechanism::Vector4::Zero();
  for (std::size_t t = 0; t < instants.size(); ++t) {
    Instant& instant = instants[t];
    if (!ok || !visit(pointAt(series, basis_.at[t]), pose, task_.width, instant)) return false;
    pose = instant.motion.pose;
    fillUses(instant);
    observations.push_back(weight.asDiagonal() * instant.regressor);
    auto here = out.limits.segment<kQuantities>(stretchOf(t) * kQuantities);
    here = here.cwiseMax((instant.uses.array() - 1.0).matrix());
    squares += instant.force.cwiseAbs2();
  }
  const mechanism::Vector4 mean = squares / static_cast<double>(instants.size());
  out.limits.tail<mechanism::kLegs>() = (mean.array() / rms_force_.array().square() - 1.0).matrix();
  const SpectralCost cost(observations, task_.directions, task_.criterion, exponent, task_.fixed_scale);
  out.cost = cost.value();
  if (with_slopes) addSlopes(instants, cost, out);
  return std::isfinite(out.cost) && out.limits.allFinite();
}

double ExcitationProblem::worstUse(const Eigen::VectorXd& variables, double enough) const {
  const FourierSeries series = this->series(variables);
  bool ok = false;
  Instant instant;
  mechanism::Pose pose = startPose(series, ok);
  double worst = 0.0;
  mechanism::Vector4 squares = mechanism::Vector4::Zero();
  for (std::size_t t = 0; ok && t < fine_.at.size(); ++t) {
    ok = visit(pointAt(series, fine_.at[t]), pose, task_.width, instant);
    if (!ok) break;
    pose = instant.motion.pose;
    fillUses(instant);
    worst = std::max(worst, instant.uses.maxCoeff());
    if (worst > enough) return worst;
    squares += instant.force.cwiseAbs2();
  }
  if (!ok) return std::numeric_limits<double>::infinity();
  const mechanism::Vector4 rms = (squares / static_cast<double>(fine_.at.size())).cwiseSqrt();
  return std::max(worst, rms.cwiseQuotient(rms_force_).maxCoeff());
}

std::optional<std::vector<PaperRegressor>> ExcitationProblem::observationsAt(
    const FourierSeries& series, const SampledBasis& basis, const dynamics::CoulombWidth& width) const {
  bool ok = false;
  mechanism::Pose pose = startPose(series, ok);
  std::vector<PaperRegressor> all;
  Instant instant;
  for (const SeriesBasis& at : basis.at) {
    if (!ok || !visit(pointAt(series, at), pose, width, instant)) return std::nullopt;
    pose = instant.motion.pose;
    all.push_back(task_.noise_N.cwiseInverse().asDiagonal() * instant.regressor);
  }
  return all;
}

std::optional<std::vector<PaperRegressor>> ExcitationProblem::observations(const FourierSeries& series) const {
  return observationsAt(series, basis_, task_.width);
}

std::optional<std::vector<PaperRegressor>> ExcitationProblem::observationsAsPlayed(const FourierSeries& series) const {
  return observationsAt(series, SampledBasis(series.shape, 1.0 / trajectory::kStreamPeriod), {});
}

std::optional<Eigen::VectorXd> ExcitationProblem::scaledToLimits(Eigen::VectorXd variables, double largest) const {
  const auto scaled = [&](double factor) {
    Eigen::VectorXd result = variables;
    result.tail(result.size() - 4) *= factor;
    return result;
  };
  const auto fits = [&](double factor) { return worstUse(scaled(factor), 1.0) <= 1.0; };
  if (fits(largest)) return scaled(largest);
  // Down from the largest in growing steps: where even rest does not fit (the rms force of standing at the centre),
  // moving may.
  for (int round = 0; round <= kCentreRounds; ++round) {
    double high = largest, low = 0.0;
    double less = kFirstLess;
    while (low == 0.0 && high > kLeastFactor * largest) {
      const double factor = std::max(0.5 * high, largest * (1.0 - less));
      (fits(factor) ? low : high) = factor;
      less *= 2.0;
    }
    while (low > 0.0 && high - low > 0.005 * high) {
      const double middle = 0.5 * (low + high);
      (fits(middle) ? low : high) = middle;
    }
    if (low > 0.0) return scaled(low);
    variables.head<4>() *= 0.5;
  }
  return std::nullopt;
}

std::optional<ExpectedLoad> expectedLoad(const mechanism::Robot& robot, const ExpectedFriction& friction) {
  if (robot.urdf.empty()) return std::nullopt;
  ExpectedLoad load;
  load.parameters.head<dynamics::kInertialParameters>() = dynamics::toParameters(dynamics::loadRobotInertia(robot));
  for (int i = 0; i < mechanism::kLegs; ++i) {
    load.parameters[dynamics::kInertialParameters + 6 * i] = friction.viscous_N_s_per_m;
    load.parameters[dynamics::kInertialParameters + 6 * i + 1] = friction.coulomb_N;
  }
  return load;
}

}  // namespace knee_robot::excitation
