// {name: screw_whirl, actuators: [2], peak_N: 20, critical_m_per_s: 0.08, at_length_m: 0.7, width_m_per_s: 0.015}
// A leg's screw near its critical speed, which is critical_m_per_s at a length and falls with the square of it: dry
// friction that is larger there, by a Gaussian peak over the speed.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kLeast_m = 0.05;

class ScrewWhirl : public EffectOf<ScrewWhirl> {
 public:
  explicit ScrewWhirl(StrictMap& entry)
      : peak_N_(entry.number("peak_N", 0.0, 1e4) * readActuators(entry)),
        critical_m_per_s_(entry.number("critical_m_per_s", 1e-3, 10.0)),
        at_length_m_(entry.number("at_length_m", 0.01, 10.0)),
        width_m_per_s_(entry.number("width_m_per_s", 1e-4, 1.0)) {}
  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const double shorter = at_length_m_ / std::max(kLeast_m, at.lengths[i]);
      const double beside = (std::abs(at.rates[i]) - critical_m_per_s_ * shorter * shorter) / width_m_per_s_;
      loads.coulomb[i] += peak_N_[i] * std::exp(-beside * beside);
    }
  }

 private:
  mechanism::Vector4 peak_N_;
  double critical_m_per_s_, at_length_m_, width_m_per_s_;
};

}  // namespace

std::unique_ptr<Effect> makeScrewWhirl(StrictMap& entry) {
  return std::make_unique<ScrewWhirl>(entry);
}

}  // namespace knee_robot::simulation
