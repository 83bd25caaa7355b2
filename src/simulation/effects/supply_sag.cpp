// {name: supply_sag, share: 0.3, half_at_N2: 20000, lag_s: 0.1, weights: [1, 1, 1, 0.25]}
// All drives hang on one supply: each loses the same share of its force, more the more is commanded together (the sum of
// the squared forces; at half_at_N2 half of `share`), with a lag. A drive with a smaller weight (another motor, which
// takes less for the same force) counts for that much less in the share; all have 1 by default.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class SupplySag : public EffectOf<SupplySag> {
 public:
  explicit SupplySag(StrictMap& entry)
      : share_(entry.number("share", 0.0, 0.9)),
        half_N2_(entry.number("half_at_N2", 1.0, 1e9)),
        lag_s_(entry.numberOr("lag_s", 0.0, 0.0, 10.0)) {
    if (!entry.has("weights")) return;
    const std::vector<double> read = entry.numbers("weights", mechanism::kLegs, 0.0, 1.0);
    weights_ = mechanism::Vector4(read.data());
  }
  void changeForce(double dt_s, mechanism::Vector4& motor_force) noexcept override {
    const double taken_N2 = motor_force.squaredNorm(),
                 now = weights_.dot(motor_force.cwiseAbs2()) / (taken_N2 + half_N2_);
    sag_ += (lag_s_ > 0.0 ? 1.0 - std::exp(-dt_s / lag_s_) : 1.0) * (now - sag_);
    motor_force *= 1.0 - share_ * sag_;
  }

 private:
  double share_, half_N2_, lag_s_;
  mechanism::Vector4 weights_ = mechanism::Vector4::Ones();
  double sag_ = 0.0;
};

}  // namespace

std::unique_ptr<Effect> makeSupplySag(StrictMap& entry) {
  return std::make_unique<SupplySag>(entry);
}

}  // namespace knee_robot::simulation
