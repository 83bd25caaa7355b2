#include "carried_load.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {
constexpr double kLately_s = 0.2, kWeight_s = 0.005, kUnweighed_s = 0.5;
constexpr double kFriction_m_per_s = 0.002;  ///< reference velocity at which friction has its whole size
/// Variances, in units of that which an axis leaves open that stands: friction, whose size is unknown, one way or the
/// other.
constexpr double kUnknownLoad = 100.0, kStanding = 0.1, kUnknownFriction = 1.0;
/// Of one second's mean. An axis that stands creeps to where friction's whole size acts: its first moments say more.
constexpr double kNoise_s = 0.05, kFirstNoise_s = 0.02, kStandingNoise_s = 0.4, kPushedNoise_s = 0.01;
constexpr double kGuidedNoise_s = 1e3;  ///< a hand pushes, too
constexpr double kStood_s = 0.5;
/// So far from its reference an axis that had settled is carried by another force; learned until so long after it.
constexpr double kPushed_m = 2e-4, kSettled_s = 0.5, kPushed_s = 0.3;
constexpr double kWander_per_s = 0.000125;  ///< in motion that keeps turning: time constants of 20 s
}  // namespace

void CarriedLoad::begin(const AxisCommand& command) noexcept {
  *this = CarriedLoad{};
  lately_N_ = command.force_N;
  weight_N_ = command.weight_N;
  beside_N_ = command.weight_N == 0.0 ? command.force_N : 0.0;
  declared_N_ = command.declared_N;
  variance_ = kUnknownLoad;
  friction_variance_ = kUnknownFriction;
}

void CarriedLoad::follow(const AxisCommand& command) noexcept {
  const double step_N = command.declared_N - declared_N_;
  if (!std::isfinite(step_N)) return;
  weight_N_ += step_N;
  beside_N_ -= step_N;
  declared_N_ = command.declared_N;
}

void CarriedLoad::learn(const AxisCommand& command, double given_N, double position_m, double dt) noexcept {
  lately_N_ += (given_N - command.pulse_N - lately_N_) * dt / (kLately_s + dt);
  stood_s_ = command.at_rest ? stood_s_ + dt : 0.0;
  if (command.per_kg_N == 0.0) addMass(-more_kg_, per_kg_N_);  // nobody knows any more how it goes with the place
  per_kg_N_ = command.per_kg_N;
  const double weight_N = command.weight_N + more_kg_ * command.per_kg_N;
  weight_N_ += (weight_N - weight_N_) * dt / (kWeight_s + dt);
  const double seen_N = given_N - command.moving_N - weight_N - command.pulse_N;
  if (weight_N == 0.0) {  // it is in it, too, and changes with the place
    beside_N_ += (seen_N - beside_N_) * dt / (kUnweighed_s + dt);
    return;
  }
  const bool away = std::abs(command.reference_m - position_m) > kPushed_m;
  settled_s_ = command.at_rest && (!away || settled_s_ >= kSettled_s) ? settled_s_ + dt : 0.0;
  pushed_ = away && settled_s_ >= kSettled_s;
  pushed_s_ = pushed_ ? kPushed_s : std::max(0.0, pushed_s_ - dt);
  correct(command, seen_N, dt);
}

/// One step of the filter.
void CarriedLoad::correct(const AxisCommand& command, double seen_N, double dt) noexcept {
  const bool stands = command.at_rest;
  if (stands) variance_ = std::max(variance_, kStanding);
  const double sense = stands ? 0.0 : std::clamp(command.reference_velocity / kFriction_m_per_s, -1.0, 1.0);
  const bool guided = !stands && command.reference_velocity == 0.0;
  const double settled = variance_ > kStanding ? kFirstNoise_s : kStandingNoise_s;
  const double standing = pushed_s_ > 0.0 ? kPushedNoise_s : settled;
  const double noise = guided ? kGuidedNoise_s : stands ? standing : kNoise_s;
  const double beside = variance_ + sense * covariance_, friction = covariance_ + sense * friction_variance_;
  const double spread = beside + sense * friction + noise / dt;
  const double error_N = seen_N - beside_N_ - sense * friction_N_;
  beside_N_ += beside / spread * error_N;
  friction_N_ += friction / spread * error_N;
  variance_ += kWander_per_s * dt - beside * beside / spread;
  covariance_ -= beside * friction / spread;
  friction_variance_ += kWander_per_s * dt - friction * friction / spread;
}

void CarriedLoad::learnAnew() noexcept {
  pushed_s_ = kPushed_s;
}

void CarriedLoad::addMass(double kg, double per_kg_N) noexcept {
  more_kg_ += kg;
  weight_N_ += kg * per_kg_N;
  beside_N_ -= kg * per_kg_N;
}

double CarriedLoad::atRest_N() const noexcept {
  return stood_s_ >= kStood_s ? lately_N_ : weight_N_ + beside_N_;
}

}  // namespace knee_robot::control
