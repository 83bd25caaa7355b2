#include "knee_robot/dynamics/warming.h"
#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Friction that changes as the drive warms up. Its state is how warm it is.
class ThermalDrift : public EffectLaw {
 public:
  ThermalDrift(double time_constant_s, const HeatSource& heated_by)
      : time_constant_s_(time_constant_s), heated_by_(heated_by) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  int coefficients() const noexcept override { return 2; }
  /// Beyond its own: how warm each recording began.
  std::vector<double> inOtherRecordings(std::vector<double> coefficients) const override {
    if (coefficients.size() > 2) coefficients.resize(2);
    return coefficients;
  }
  void columns(const EffectInstant& at, EffectState& state, EffectColumns& out) const noexcept override {
    const double velocity_m_per_s = at.velocity_m_per_s[at.actuator];
    Warmth warmth{state.value};
    state.value = warmth.move(heated_by_, velocity_m_per_s, at.period_s, time_constant_s_);
    const double change = felt(heated_by_, state.value);
    out[0] = change * at.share;
    out[1] = change * velocity_m_per_s;
  }
  void rest(double duration_s, EffectState& state) const noexcept override {
    Warmth warmth{state.value};
    state.value = warmth.cool(heated_by_.by, duration_s, time_constant_s_);
  }

 private:
  const double time_constant_s_;
  const HeatSource heated_by_;
};

}  // namespace

Law thermalDriftLaw(const Shape& shape) {
  const std::optional<Heat> heated_by = shape.size() > 1 ? heatOf(shape[1]) : Heat::Clock;
  const double viscous_s_per_m = shape.size() > 2 ? shape[2] : 0.0;  // fewer: of a file that did not know it
  const double levels_off = shape.size() > 3 ? shape[3] : 0.0;
  if (!heated_by || *heated_by == Heat::Winding || !(viscous_s_per_m >= 0.0) || !(levels_off >= 0.0)) return nullptr;
  return std::make_unique<ThermalDrift>(shape[0], HeatSource{*heated_by, viscous_s_per_m, levels_off});
}

}  // namespace knee_robot::dynamics
