// {name: near_rest_friction, actuators: [1, 2], law: lugre, distance_m: 1.0e-4} {name: near_rest_friction, law: tanh,
// speed_m_per_s: 0.001} How dry friction comes up from rest, in place of ideal stiction; its level stays what the plant
// and the effects before this one make it: put it last. Laws: tanh and rational (v / (|v| + speed)) are functions of
// velocity and creep under load; lugre (bristles that bend over `distance_m` and creep) and maxwell_slip (four stops,
// 0.25 to 2 times `distance_m`) remember their way.
#include <algorithm>
#include <array>
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr std::size_t kStops = 4;
constexpr std::array<double, kStops> kStretch = {0.25, 0.5, 1.0, 2.0};

class NearRestFriction : public EffectOf<NearRestFriction> {
 public:
  explicit NearRestFriction(StrictMap& entry)
      : law_(entry.choice("law", {"tanh", "rational", "lugre", "maxwell_slip"})), on_(readActuators(entry)) {
    if (law_ == "tanh" || law_ == "rational") {
      speed_ = entry.number("speed_m_per_s", 1e-5, 0.1);
    } else {
      distance_ = entry.number("distance_m", 1e-6, 1e-2);
    }
  }

  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i) {
      if (on_[i] == 0.0) continue;
      level_[i] = loads.coulomb[i];
      loads.coulomb[i] = 0.0;
      if (distance_ > 0.0) continue;
      // As a viscosity, which the plant solves implicitly: the slope at rest is steep.
      loads.viscous[i] += level_[i] * sharePerSpeed(at.rates[i]);
    }
  }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    if (distance_ <= 0.0) return;
    for (int i = 0; i < mechanism::kLegs; ++i) {
      if (on_[i] == 0.0) continue;
      loads.motor_force[i] -= level_[i] * share(i);
      loads.viscous[i] += damping(at.rates[i]);
    }
  }
  double dryFriction(int leg, double level_N, double rate, double rate_after,
                     double friction_N) const noexcept override {
    if (on_[leg] == 0.0) return friction_N;
    const double mean = 0.5 * (rate + rate_after);
    return distance_ > 0.0 ? level_N * share(leg) + damping(rate) * mean : level_N * sharePerSpeed(rate) * mean;
  }
  void follow(const EffectStep& now) noexcept override {
    for (int i = 0; i < mechanism::kLegs && distance_ > 0.0; ++i) {
      const std::size_t leg = static_cast<std::size_t>(i);
      const double step = now.rates[i] * now.dt_s;
      if (law_ == "lugre") {  // dz = v dt - |v| dt z / distance, exact over a step of constant velocity
        const double end = std::copysign(1.0, step);
        state_[leg][0] = end - (end - state_[leg][0]) * std::exp(-std::abs(step) / distance_);
        continue;
      }
      for (std::size_t k = 0; k < kStops; ++k)
        state_[leg][k] = std::clamp(state_[leg][k] + step / (kStretch[k] * distance_), -1.0, 1.0);
    }
  }

 private:
  static constexpr double kDamping = 200.0;       ///< N s/m of the bristles, while slow
  static constexpr double kSlow_m_per_s = 0.005;  ///< they are straight when it is faster

  static double damping(double rate) noexcept { return kDamping * std::exp(-std::abs(rate) / kSlow_m_per_s); }
  /// Of the level, s/m, for the laws that are functions of velocity.
  double sharePerSpeed(double rate) const noexcept {
    const double v = std::abs(rate);
    if (law_ == "rational") return 1.0 / (v + speed_);
    return v > 1e-9 ? std::tanh(v / speed_) / v : 1.0 / speed_;
  }
  double share(int i) const noexcept {
    const auto& s = state_[static_cast<std::size_t>(i)];
    return law_ == "lugre" ? s[0] : 0.25 * (s[0] + s[1] + s[2] + s[3]);
  }

  std::string law_;
  mechanism::Vector4 on_;
  double speed_ = 0.0, distance_ = 0.0;
  mechanism::Vector4 level_ = mechanism::Vector4::Zero();
  std::array<std::array<double, kStops>, mechanism::kLegs> state_{};
};

}  // namespace

std::unique_ptr<Effect> makeNearRestFriction(StrictMap& entry) {
  return std::make_unique<NearRestFriction>(entry);
}

}  // namespace knee_robot::simulation
