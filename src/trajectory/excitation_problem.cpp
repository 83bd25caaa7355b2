#include "excitation_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knee_robot {
namespace {

constexpr double kObservationHertz = 10.0;  ///< highest harmonic of the default series: 0.44 Hz
constexpr double kLimitHertz = 25.0;
constexpr double kTranslationUnit = 0.1;  ///< m of pose that one unit of a variable moves
constexpr double kRotationUnit = 0.3;     ///< rad
/// Smoothed signs, so that a gradient exists; narrow beside 0.1 m/s.
constexpr CoulombWidth kCoulombWidth{1e-3, 3e-3};
constexpr double kLengthStep = 1e-6, kVelocityStep = 1e-6, kAccelerationStep = 1e-4;  ///< of central differences
constexpr int kCentreRounds = 6;     ///< of halving a centre's distance from the middle until it is within the limits
constexpr int kScaleRounds = 20;     ///< of bisection
constexpr double kNearLimit = 0.95;  ///< use below which a limit's gradient is not needed

double excess(double use) {
  const double beyond = std::max(0.0, use - 1.0);
  return beyond * beyond;
}

}  // namespace

struct ExcitationProblem::Instant {
  Motion motion;
  PaperRegressor observation;
  LimitUse use;
  RegressorData data;
  ExtendedRegressor extended;
};

SampledBasis::SampledBasis(const SeriesShape& shape, double rate_hz) {
  const long last = std::lround(shape.duration_s * rate_hz);
  for (long k = 0; k <= last; ++k)
    at.push_back(seriesBasis(shape, static_cast<double>(k) * shape.duration_s / static_cast<double>(last)));
}

ExcitationProblem::ExcitationProblem(const Robot& robot, const SeriesShape& shape, int directions, bool twin_legs,
                                     const Pose& centre)
    : robot_(robot),
      shape_(shape),
      directions_(directions),
      centre_lengths_(legLengths(*robot.mechanism, centre)),
      centre_pose_(centre),
      unit_(lengthJacobian(*robot.mechanism, centre) *
            Vector4(kTranslationUnit, kTranslationUnit, kRotationUnit, kRotationUnit).asDiagonal()),
      coarse_(shape, kObservationHertz),
      fine_(shape, kLimitHertz) {
  if (!twin_legs) return;
  unit_.row(1) = 0.5 * (unit_.row(1) + unit_.row(2)).eval();
  unit_.row(2) = unit_.row(1);
  centre_lengths_[1] = 0.5 * (centre_lengths_[1] + centre_lengths_[2]);
  centre_lengths_[2] = centre_lengths_[1];
}

FourierSeries ExcitationProblem::series(const Eigen::VectorXd& variables) const {
  FourierSeries series;
  series.shape = shape_;
  series.space = Space::Actuator;
  series.centre = centre_lengths_ + unit_ * variables.head<4>();
  series.coefficients = unit_ * Eigen::Map<const Eigen::Matrix<double, 4, Eigen::Dynamic>>(variables.data() + 4, 4,
                                                                                           coefficientColumns(shape_));
  return series;
}

LimitUse ExcitationProblem::limitUse(const SeriesPoint& point, const Motion& motion) const {
  LimitUse use;
  const auto take = [&use](double ratio) {
    use.worst = std::max(use.worst, ratio);
    use.penalty += excess(ratio);
  };
  for (int i = 0; i < kLegs; ++i) {
    const Actuator& actuator = robot_.actuators[i];
    const double middle = 0.5 * (actuator.position_min_m + actuator.position_max_m);
    take(std::abs(point.value[i] - middle) / (actuator.position_max_m - middle));
    take(std::abs(point.rate[i]) / actuator.velocity_max_m_per_s);
    take(std::abs(point.acceleration[i]) / actuator.acceleration_max_m_per_s2);
  }
  const JointAngles angles = jointAngles(*robot_.mechanism, motion.pose);
  for (int i = 0; i < kLegs; ++i) {
    take(angles.base[i] / (i < 3 ? robot_.joints.universal_max : robot_.joints.revolute_max));
    if (i < 3) take(angles.platform[i] / robot_.joints.spherical_max);
  }
  take(conditionNumber(*robot_.mechanism, motion.pose) / robot_.singularity_condition_max);
  return use;
}

bool ExcitationProblem::evaluate(const SeriesPoint& point, const Pose& guess, bool with_limits, Instant& out) const {
  const Mechanism& mechanism = *robot_.mechanism;
  if (motionFromLengths(mechanism, point.value, point.rate, point.acceleration, guess, out.motion) !=
      ForwardStatus::Converged) {
    return false;
  }
  if (!extendedRegressor(mechanism, robot_.gravity, out.motion, out.data, out.extended, kCoulombWidth)) return false;
  out.observation =
      out.extended.leftCols<kPaperParameters>();  // the paper's columns come first; rotor and offset after them
  if (with_limits) out.use = limitUse(point, out.motion);
  return true;
}

Pose ExcitationProblem::startPose(const FourierSeries& series, bool& ok) const {
  const ForwardResult start = forwardKinematics(*robot_.mechanism, series.centre, centre_pose_);
  ok = start.ok();
  return start.pose;
}

void ExcitationProblem::addGradient(const Instant& at, const SeriesPoint& point, const SeriesBasis& basis,
                                    const PaperRegressor& direction, double penalty_weight,
                                    Eigen::Matrix<double, 4, Eigen::Dynamic>& gradient) const {
  const bool with_limits = at.use.worst > kNearLimit;
  static thread_local Instant nearby;
  const auto value = [&](const SeriesPoint& moved) {
    if (!evaluate(moved, at.motion.pose, with_limits, nearby)) return 0.0;
    return direction.cwiseProduct(nearby.observation).sum() + (with_limits ? penalty_weight * nearby.use.penalty : 0.0);
  };
  for (int i = 0; i < kLegs; ++i) {
    const auto slope = [&](Vector4 SeriesPoint::*part, double step) {
      SeriesPoint ahead = point, behind = point;
      (ahead.*part)[i] += step;
      (behind.*part)[i] -= step;
      return (value(ahead) - value(behind)) / (2.0 * step);
    };
    const double by_value = slope(&SeriesPoint::value, kLengthStep), by_rate = slope(&SeriesPoint::rate, kVelocityStep),
                 by_acceleration = slope(&SeriesPoint::acceleration, kAccelerationStep);
    gradient(i, 0) += by_value;
    gradient.row(i).tail(coefficientColumns(shape_)) +=
        by_value * basis.value + by_rate * basis.rate + by_acceleration * basis.acceleration;
  }
}

std::optional<double> ExcitationProblem::cost(const Eigen::VectorXd& variables, double penalty_weight,
                                              Eigen::VectorXd* gradient) const {
  const FourierSeries series = this->series(variables);
  bool ok = false;
  Pose pose = startPose(series, ok);
  if (!ok) return std::nullopt;
  const std::size_t n = coarse_.at.size();
  std::vector<PaperRegressor> observations(n);
  std::vector<Instant> instants(gradient ? n : 1);
  double penalty = 0.0;
  for (std::size_t t = 0; t < n; ++t) {
    Instant& instant = instants[gradient ? t : 0];
    if (!evaluate(pointAt(series, coarse_.at[t]), pose, true, instant)) return std::nullopt;
    pose = instant.motion.pose;
    observations[t] = instant.observation;
    penalty += instant.use.penalty;
  }
  const LogCondition condition(observations, directions_);
  if (gradient) {
    Eigen::Matrix<double, 4, Eigen::Dynamic> by_series =
        Eigen::Matrix<double, 4, Eigen::Dynamic>::Zero(4, 1 + coefficientColumns(shape_));
    for (std::size_t t = 0; t < n; ++t) {
      addGradient(instants[t], pointAt(series, coarse_.at[t]), coarse_.at[t], condition.gradient(observations[t]),
                  penalty_weight, by_series);
    }
    const Eigen::MatrixXd by_variable = unit_.transpose() * by_series;
    *gradient = Eigen::Map<const Eigen::VectorXd>(by_variable.data(), by_variable.size());
  }
  return condition.value() + penalty_weight * penalty;
}

double ExcitationProblem::worstUse(const FourierSeries& series) const {
  bool ok = false;
  Motion motion;
  motion.pose = startPose(series, ok);
  double worst = 0.0;
  for (std::size_t t = 0; ok && t < fine_.at.size(); ++t) {
    const SeriesPoint point = pointAt(series, fine_.at[t]);
    const ForwardResult found = forwardKinematics(*robot_.mechanism, point.value, motion.pose);
    motion.pose = found.pose;
    ok = found.ok();
    if (ok) worst = std::max(worst, limitUse(point, motion).worst);
    if (worst > 1e3) break;
  }
  return ok ? worst : std::numeric_limits<double>::infinity();
}

std::optional<std::vector<PaperRegressor>> ExcitationProblem::observations(const FourierSeries& series) const {
  bool ok = false;
  Pose pose = startPose(series, ok);
  std::vector<PaperRegressor> all;
  Instant instant;
  for (const SeriesBasis& basis : coarse_.at) {
    if (!ok || !evaluate(pointAt(series, basis), pose, false, instant)) return std::nullopt;
    pose = instant.motion.pose;
    all.push_back(instant.observation);
  }
  return all;
}

std::optional<Eigen::VectorXd> ExcitationProblem::scaledToLimits(Eigen::VectorXd variables, double largest) const {
  const auto scaled = [&](double factor) {
    Eigen::VectorXd result = variables;
    result.tail(result.size() - 4) *= factor;
    return result;
  };
  const auto fits = [&](double factor) { return worstUse(series(scaled(factor))) <= 1.0; };
  if (fits(largest)) return scaled(largest);
  for (int round = 0; !fits(0.0); ++round) {
    if (round == kCentreRounds) return std::nullopt;
    variables.head<4>() *= 0.5;
  }
  double low = 0.0, high = largest;
  for (int round = 0; round < kScaleRounds && high - low > 0.005 * high; ++round) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  if (low == 0.0) return std::nullopt;
  return scaled(low);
}

}  // namespace knee_robot
