// {name: reversal_friction, actuators: [2], excess_N: 20, way_m: 0.01, rise_m: 0.001}
// Coulomb friction is larger after every reversal of a leg: it rises over one way and falls off over a longer one,
// excess (1 - exp(-w / rise)) exp(-w / way), w from where the leg turned last; less than 20 um back is no reversal.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kNoReversal_m = 2e-5;

class ReversalFriction : public EffectOf<ReversalFriction> {
 public:
  explicit ReversalFriction(StrictMap& entry)
      : excess_N_(entry.number("excess_N", 0.0, 1e4) * readActuators(entry)),
        way_m_(entry.number("way_m", 1e-4, 1.0)),
        rise_m_(entry.numberOr("rise_m", 0.0, 0.0, 0.1)) {}
  void start(const EffectStep& at) noexcept override { turned_ = extreme_ = at_ = at.lengths; }
  void changeFriction(const EffectStep&, PlantLoads& loads) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const double way = std::abs(at_[i] - turned_[i]), risen = rise_m_ > 0.0 ? 1.0 - std::exp(-way / rise_m_) : 1.0;
      loads.coulomb[i] += excess_N_[i] * risen * std::exp(-way / way_m_);
    }
  }
  void follow(const EffectStep& now) noexcept override {
    at_ = now.lengths;
    for (int i = 0; i < mechanism::kLegs; ++i) {
      if (direction_[i] == 0.0 && std::abs(at_[i] - turned_[i]) > kNoReversal_m)
        direction_[i] = std::copysign(1.0, at_[i] - turned_[i]);
      if (direction_[i] * (at_[i] - extreme_[i]) >= 0.0) extreme_[i] = at_[i];
      if (direction_[i] * (extreme_[i] - at_[i]) <= kNoReversal_m) continue;
      turned_[i] = extreme_[i];
      extreme_[i] = at_[i];
      direction_[i] = -direction_[i];
    }
  }

 private:
  mechanism::Vector4 excess_N_;
  double way_m_, rise_m_;
  mechanism::Vector4 at_ = mechanism::Vector4::Zero(), turned_ = mechanism::Vector4::Zero(),
                     extreme_ = mechanism::Vector4::Zero(), direction_ = mechanism::Vector4::Zero();
};

}  // namespace

std::unique_ptr<Effect> makeReversalFriction(StrictMap& entry) {
  return std::make_unique<ReversalFriction>(entry);
}

}  // namespace knee_robot::simulation
