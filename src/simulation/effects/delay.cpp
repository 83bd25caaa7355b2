// {name: delay, actuators: [1, 2, 3, 4], time_s: 0.002}
// The motors follow their commands this much later; between simulated periods the command is interpolated linearly.
#include <array>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr std::size_t kKept = 512;  ///< periods

class Delay : public EffectOf<Delay> {
 public:
  explicit Delay(StrictMap& entry) : actuators_(readActuators(entry)), time_s_(entry.number("time_s", 0.0, 0.1)) {
    past_.fill(mechanism::Vector4::Zero());
  }
  void changeForce(double dt_s, mechanism::Vector4& motor_force) noexcept override {
    newest_ = (newest_ + 1) % kKept;
    past_[newest_] = motor_force;
    const double periods = std::min(time_s_ / dt_s, static_cast<double>(kKept - 2));
    const std::size_t whole = static_cast<std::size_t>(periods);
    const double part = periods - static_cast<double>(whole);
    const mechanism::Vector4 late = (1.0 - part) * ago(whole) + part * ago(whole + 1);
    motor_force += actuators_.cwiseProduct(late - motor_force);
  }

 private:
  const mechanism::Vector4& ago(std::size_t periods) const noexcept {
    return past_[(newest_ + kKept - periods) % kKept];
  }

  mechanism::Vector4 actuators_;
  double time_s_;
  std::array<mechanism::Vector4, kKept> past_;
  std::size_t newest_ = 0;
};

}  // namespace

std::unique_ptr<Effect> makeDelay(StrictMap& entry) {
  return std::make_unique<Delay>(entry);
}

}  // namespace knee_robot::simulation
