#pragma once

#include <cmath>
#include <vector>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/trajectory/reference_file.h"

namespace knee_robot::fake {

inline constexpr double kHome = 0.6;

/// Four actuators without platform: three legs of 28.46 N/V and one of 246.7 N/V.
inline mechanism::Robot robot() {
  mechanism::Robot robot;
  robot.path = "fake.yaml";
  robot.kind = mechanism::MechanismKind::Axes;
  mechanism::Actuator leg;
  leg.position_min_m = 0.5;
  leg.position_max_m = 1.0;
  leg.velocity_max_m_per_s = 0.3;
  leg.acceleration_max_m_per_s2 = 5.0;
  leg.screw_lead_m = 0.020;
  leg.counts_per_revolution = 1000;
  leg.home_length_m = kHome;
  leg.force_per_volt_N = 28.4628;
  leg.voltage_max_V = 9.5;
  robot.actuators = {leg, leg, leg, leg};
  robot.actuators[1].encoder_sign = -1;
  robot.actuators[2].force_sign = -1;
  robot.actuators[3].screw_lead_m = 0.00465;
  robot.actuators[3].counts_per_revolution = 2000;
  robot.actuators[3].force_per_volt_N = 246.6779;
  robot.actuators[3].force_max_N = 1000.0;
  for (mechanism::Actuator& one : robot.actuators)
    one.force_continuous_N = 300.0;
  return robot;
}

inline control::HardwareFile hardware() {
  control::HardwareFile hardware;
  hardware.path = "fake_hardware.yaml";
  hardware.backend = "simulated";
  hardware.axes.fill({control::HoldDevice::Brake, 0.03});
  return hardware;
}

/// One mass an axis, pulled down by a load, with viscous friction, motor and brake: enough of a machine to see it fall
/// when the order of a safe stop is wrong. Not the project's simulated robot.
class Machine : public hardware::AxisBus {
 public:
  struct Axis {
    double mass = 5.0, viscous = 100.0, load_N = 40.0;
    double position = kHome, velocity = 0.0;
    bool jammed = false;
    bool encoder_frozen = false;               // the counter keeps what it has
    double encoder_offset_m = 0.0;             // what a jump has added to it
    bool wrong_sign = false;                   // motor wired the wrong way round
    bool drive_dead = false;                   // enabled, but no force
    double push_N = 0.0;                       // by somebody, positive lengthens
    double stop_min = -10.0, stop_max = 10.0;  // ends of the stroke
    double switch_below = -10.0;               // the home switch is closed below that position
    std::int32_t frozen_counts = 0;
  };
  /// What went over the wire in one cycle.
  struct Event {
    double time_s;
    unsigned bits;
    control::AxisValues volts;
  };

  explicit Machine(const mechanism::Robot& robot) : robot_(robot) {
    axes[0].mass = 1.4;
    axes[3].mass = 30.0;
    axes[3].load_N = 120.0;
    events.reserve(200'000);
  }

  std::array<Axis, hardware::kAxes> axes;
  std::vector<Event> events;
  hardware::IoStatus read_status = hardware::IoStatus::Ok;
  hardware::IoStatus volts_status = hardware::IoStatus::Ok;
  hardware::IoStatus outputs_status = hardware::IoStatus::Ok;
  std::uint8_t inputs = 0xf;
  std::uint8_t bits = 0;
  control::AxisValues volts{};
  bool passes_self_test = true;
  double encoder_zero = kHome;  // where the counters were reset
  int switch_bit = -1;          // digital input of the home switches, -1: none
  double time_s = 0.0;
  double brake_delay_s = 0.03;

  bool enabled() const { return (bits & 1) != 0; }
  bool released() const { return (bits & 2) != 0; }

  hardware::SelfTest selfTest() override {
    bits = 0;
    volts = {};
    return {passes_self_test, {passes_self_test ? "all well" : "the card does not answer"}};
  }
  hardware::IoStatus read(hardware::AxisFeedback& feedback) noexcept override {
    if (read_status != hardware::IoStatus::Ok) return read_status;
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      const mechanism::Actuator& actuator = robot_.actuators[i];
      Axis& axis = axes[i];
      const double counts =
          actuator.encoder_sign * (axis.position + axis.encoder_offset_m - encoder_zero) / actuator.metresPerCount();
      if (!axis.encoder_frozen)
        axis.frozen_counts = static_cast<std::int32_t>(static_cast<std::int64_t>(std::llround(counts)));
      feedback.counts[i] = axis.frozen_counts;
    }
    feedback.digital_inputs = inputs;
    if (switch_bit >= 0) {
      bool closed = false;
      for (const Axis& axis : axes)
        closed = closed || axis.position < axis.switch_below;
      feedback.digital_inputs &= static_cast<std::uint8_t>(~(1u << switch_bit));
      if (closed) feedback.digital_inputs |= static_cast<std::uint8_t>(1u << switch_bit);
    }
    return hardware::IoStatus::Ok;
  }
  hardware::IoStatus writeVolts(const control::AxisValues& wanted, control::AxisValues& written) noexcept override {
    if (volts_status != hardware::IoStatus::Ok) return volts_status;
    for (double value : wanted) {
      if (!std::isfinite(value)) return hardware::IoStatus::NotFinite;
    }
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      volts[i] = std::round(std::min(10.0, std::max(-10.0, wanted[i])) / kStep) * kStep;
    }
    written = volts;
    return hardware::IoStatus::Ok;
  }
  hardware::IoStatus writeOutputs(std::uint8_t wanted) noexcept override {
    if (outputs_status != hardware::IoStatus::Ok) return outputs_status;
    if (released() && (wanted & 2) == 0) brake_ordered_s_ = time_s;
    bits = wanted;
    if (events.size() < events.capacity()) events.push_back({time_s, wanted, volts});
    return hardware::IoStatus::Ok;
  }

  /// Moves the masses on to `time_s`.
  void advanceTo(double end_s) {
    constexpr double kDt = 1e-4;
    while (time_s + 0.5 * kDt < end_s) {
      time_s += kDt;
      const bool braked = !released() && time_s - brake_ordered_s_ >= brake_delay_s;
      for (std::size_t i = 0; i < hardware::kAxes; ++i)
        move(i, braked, kDt);
    }
  }

 private:
  static constexpr double kStep = 20.0 / 4096.0;

  void move(std::size_t i, bool braked, double dt) {
    Axis& axis = axes[i];
    if (braked || axis.jammed) {
      axis.velocity = 0.0;
      return;
    }
    const mechanism::Actuator& actuator = robot_.actuators[i];
    double motor = enabled() && !axis.drive_dead ? actuator.force_sign * actuator.force_per_volt_N * volts[i] : 0.0;
    if (axis.wrong_sign) motor = -motor;
    axis.velocity += dt * (motor + axis.push_N - axis.load_N - axis.viscous * axis.velocity) / axis.mass;
    axis.position += dt * axis.velocity;
    const double inside = std::min(axis.stop_max, std::max(axis.stop_min, axis.position));
    if (inside != axis.position) axis.velocity = 0.0;
    axis.position = inside;
  }

  const mechanism::Robot robot_;
  double brake_ordered_s_ = -1.0;
};

/// Rest to rest over `distance` from `start`, `seconds` long, the same on all axes (minimum jerk).
inline trajectory::Reference smoothReference(double start, double distance, double seconds) {
  trajectory::Reference reference;
  reference.name = "smooth.txt";
  const auto intervals = static_cast<Eigen::Index>(std::lround(seconds / trajectory::kStreamPeriod));
  reference.points.resize(intervals + 1, 4);
  for (Eigen::Index k = 0; k <= intervals; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(intervals);
    reference.points.row(k).setConstant(start + distance * x * x * x * (10.0 + x * (6.0 * x - 15.0)));
  }
  return reference;
}

}  // namespace knee_robot::fake
