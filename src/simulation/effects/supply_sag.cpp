// {name: supply_sag, share: 0.3, half_at_N2: 20000, lag_s: 0.1, weights: [1, 1, 1, 0.25], work_N2_per_W: 1000}
// All drives hang on one supply: each loses the same share of its force, more the more is commanded together (the sum of
// the squared forces; at half_at_N2 half of `share`), with a lag. A drive with a smaller weight (another motor, which
// takes less for the same force) counts for that much less in the share; all have 1 by default. Behind switching
// amplifiers the supply also gives the work that the drives do: each watt counts as so many N^2 (default 0). What they
// feed back spares the others theirs and raises no voltage.
#include <algorithm>
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class SupplySag : public EffectOf<SupplySag> {
 public:
  explicit SupplySag(StrictMap& entry)
      : share_(entry.number("share", 0.0, 0.9)),
        half_N2_(entry.number("half_at_N2", 1.0, 1e9)),
        lag_s_(entry.numberOr("lag_s", 0.0, 0.0, 10.0)),
        work_N2_per_W_(entry.numberOr("work_N2_per_W", 0.0, 0.0, 1e5)) {
    if (!entry.has("weights")) return;
    const std::vector<double> read = entry.numbers("weights", mechanism::kLegs, 0.0, 1.0);
    weights_ = mechanism::Vector4(read.data());
  }
  void changeForce(double dt_s, mechanism::Vector4& motor_force) noexcept override {
    const mechanism::Vector4 taken_N2 =
        motor_force.cwiseAbs2() + work_N2_per_W_ * motor_force.cwiseProduct(rates_m_per_s_);
    const double now = std::max(0.0, weights_.dot(taken_N2)) / (std::max(0.0, taken_N2.sum()) + half_N2_);
    sag_ += (lag_s_ > 0.0 ? 1.0 - std::exp(-dt_s / lag_s_) : 1.0) * (now - sag_);
    motor_force *= 1.0 - share_ * std::min(1.0, sag_);
  }
  void follow(const EffectStep& now) noexcept override { rates_m_per_s_ = now.rates; }

 private:
  double share_, half_N2_, lag_s_, work_N2_per_W_;
  mechanism::Vector4 weights_ = mechanism::Vector4::Ones(), rates_m_per_s_ = mechanism::Vector4::Zero();
  double sag_ = 0.0;
};

}  // namespace

std::unique_ptr<Effect> makeSupplySag(StrictMap& entry) {
  return std::make_unique<SupplySag>(entry);
}

}  // namespace knee_robot::simulation
