// {name: idle_current_reduction, actuators: [4], cut: 0.1, below_m_per_s: 0.002, after_s: 0.3, time_constant_s: 0.5}
// The drive takes `cut` of its current away once the axis has been slower than that for so long, and gives all of it
// within 0.1 s when it moves.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kGivesAgain_s = 0.1;

class IdleCurrentReduction : public EffectOf<IdleCurrentReduction> {
 public:
  explicit IdleCurrentReduction(StrictMap& entry)
      : cut_(entry.number("cut", 0.0, 0.9) * readActuators(entry)),
        below_m_per_s_(entry.numberOr("below_m_per_s", 0.002, 1e-5, 0.1)),
        after_s_(entry.numberOr("after_s", 0.3, 0.0, 100.0)),
        time_constant_s_(entry.numberOr("time_constant_s", 0.5, 1e-3, 100.0)) {}
  void changeForce(double dt_s, mechanism::Vector4& motor_force) noexcept override {
    for (Eigen::Index i = 0; i < motor_force.size(); ++i) {
      stood_s_[i] = std::abs(rates_[i]) < below_m_per_s_ ? stood_s_[i] + dt_s : 0.0;
      const bool cuts = stood_s_[i] >= after_s_;
      const double settled = cuts ? 1.0 : 0.0;
      idle_[i] = settled + (idle_[i] - settled) * std::exp(-dt_s / (cuts ? time_constant_s_ : kGivesAgain_s));
      motor_force[i] *= 1.0 - cut_[i] * idle_[i];
    }
  }
  void follow(const EffectStep& now) noexcept override { rates_ = now.rates; }

 private:
  mechanism::Vector4 cut_;
  double below_m_per_s_, after_s_, time_constant_s_;
  mechanism::Vector4 rates_ = mechanism::Vector4::Zero();
  mechanism::Vector4 stood_s_ = mechanism::Vector4::Zero(), idle_ = mechanism::Vector4::Zero();
};

}  // namespace

std::unique_ptr<Effect> makeIdleCurrentReduction(StrictMap& entry) {
  return std::make_unique<IdleCurrentReduction>(entry);
}

}  // namespace knee_robot::simulation
