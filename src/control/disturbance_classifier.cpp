#include "disturbance_classifier.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {

constexpr double kLeastGravity = 0.1;  // m/s^2; below it nothing has a weight
constexpr double kMoves = 0.95;        // of ResidualEstimator::Estimate::moving: friction is certain
constexpr double kMostlyMoves = 0.8;
constexpr double kBegun_s = 0.05;     // of weight: what is there at the start is no push
constexpr double kPushWeight = 0.01;  // at rest; kRestWeight without a push
constexpr double kKnown = 0.25;       // of kMean_s: a load is not said before
constexpr double kHysteresis = 0.7;   // what was said is taken back below that share of its limit

}  // namespace

void DisturbanceClassifier::Direction::take(double residual, double friction, double dt) noexcept {
  time_s = std::min(kFriction_s, time_s + dt);
  residual_N += dt / time_s * (residual - residual_N);
  friction_N += dt / time_s * (friction - friction_N);
}

void DisturbanceClassifier::reset() noexcept {
  mean_.setZero();
  weight_s_ = away_s_ = beyond_s_ = 0.0;
  out_.carries = out_.pushed = false;
  out_.holds = true;
  out_.load_kg = out_.load_m = 0.0;
  out_.push.setZero();
}

void DisturbanceClassifier::estimateLoad(const ForceKnowledge& knowledge, const ResidualEstimator::Estimate& now,
                                         double dt) noexcept {
  const mechanism::Vector4 friction = now.jacobian.cwiseAbs().transpose() * knowledge.coulomb_N;
  const mechanism::Vector4 limit = now.wrench_band.cwiseMax(kReversal * friction);
  // Friction may hide a part of what is beside the load, not of the load itself.
  const mechanism::Vector4 load_N = -now.jacobian.transpose().partialPivLu().solve(mean_);
  const mechanism::Vector4 beside =
      -now.jacobian.transpose() * ResidualEstimator::certain(now.residual_N - load_N, now.hidden_N);
  if (!beside.allFinite()) return;
  const bool moves = now.moving.mean() > kMostlyMoves, away = (beside.cwiseAbs() - limit).maxCoeff() > 0.0;
  const double gain = dt * (moves ? 1.0 : away && weight_s_ > kBegun_s ? kPushWeight : kRestWeight);
  weight_s_ = std::min(kMean_s, weight_s_ + gain);
  mean_ += gain / weight_s_ * beside;
  away_s_ = away ? away_s_ + dt : 0.0;
  out_.push = beside;
  out_.pushed = away_s_ >= kPush_s;
  const double carried = std::abs(mean_[1]) / std::max(kLoad * friction[1], limit[1]);
  const bool steady = weight_s_ > kKnown * kMean_s && std::abs(mean_[0]) < limit[0] + 0.5 * std::abs(mean_[1]);
  out_.carries = steady && carried > (out_.carries ? kHysteresis : 1.0);
  const double gravity = knowledge.parts.gravity.norm();
  out_.load_kg = gravity > kLeastGravity ? -mean_[1] / gravity : 0.0;
  out_.load_m = carried > kHysteresis ? -mean_[2] / mean_[1] : 0.0;
}

void DisturbanceClassifier::estimateFriction(const ForceKnowledge& knowledge, const ResidualEstimator::Estimate& now,
                                             double dt) noexcept {
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const auto leg = static_cast<Eigen::Index>(i);
    const double friction = now.friction_N[leg];
    const std::size_t way = friction > 0.0 ? 0 : 1;
    if (now.moving[leg] > kMoves && !out_.pushed) directions_[i][way].take(now.residual_N[leg], friction, dt);
    if (now.moving[leg] > kMoves) pushed_or_not_[i][way].take(now.residual_N[leg], friction, dt);
    const Difference difference = differenceOf(directions_[i]);
    out_.friction_growth[leg] = difference.growth();
    out_.friction_least[leg] = std::min({0.0, difference.growth(), differenceOf(pushed_or_not_[i]).growth()});
    const double share = out_.friction_changed[i] ? kHysteresis : 1.0;
    out_.friction_changed[i] = std::abs(out_.friction_growth[leg]) > share * kFrictionChange &&
                               0.5 * std::abs(difference.found_N) > share * knowledge.band_N[leg];
  }
}

DisturbanceClassifier::Difference DisturbanceClassifier::differenceOf(
    const std::array<Direction, 2>& directions) noexcept {
  const auto& [forwards, backwards] = directions;
  if (std::min(forwards.time_s, backwards.time_s) < kFrictionLeast_s) return {};
  return {forwards.residual_N - backwards.residual_N, forwards.friction_N - backwards.friction_N};
}

const DisturbanceClassifier::Verdict& DisturbanceClassifier::step(const ForceKnowledge& knowledge,
                                                                  const ResidualEstimator::Estimate& now, double dt,
                                                                  bool guided) noexcept {
  if (!now.known) {
    reset();
    return out_;
  }
  if (!knowledge.identified) return out_;
  if (knowledge.parts.mechanism) estimateLoad(knowledge, now, dt);
  if (guided) return out_;
  estimateFriction(knowledge, now, dt);
  const bool beyond = (now.rms_N - knowledge.band_N).maxCoeff() > 0.0;
  beyond_s_ = beyond ? std::min(kHolds_s, beyond_s_ + dt) : std::max(0.0, beyond_s_ - dt);
  const bool explained =
      out_.carries || out_.pushed ||
      std::any_of(out_.friction_changed.begin(), out_.friction_changed.end(), [](bool b) { return b; });
  if (explained) beyond_s_ = 0.0;
  out_.holds = beyond_s_ < kHolds_s;
  return out_;
}

}  // namespace knee_robot::control
