#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "test/simulation/plant_bench.h"

namespace knee_robot::simulation {

inline constexpr int kAxis = 1;  ///< whose effects the tests look at

/// One millisecond as the controller's side knows it: what it commanded, what its encoders say; and the simulator's
/// truth.
struct EffectSample {
  double time_s = 0.0;
  mechanism::Lengths reference = mechanism::Lengths::Zero(), seen = mechanism::Lengths::Zero(),
                     truth = mechanism::Lengths::Zero();
  mechanism::Vector4 rates = mechanism::Vector4::Zero();  ///< true ones, m/s
  mechanism::Vector4 force = mechanism::Vector4::Zero();  ///< commanded, N
  mechanism::Vector4 friction = mechanism::Vector4::
      Zero();  ///< commanded force minus that of frictionless rigid links and rotors along the true motion
};

/// A simulated robot with effects, moved along lengths by a stiff position controller through its cards: volts in,
/// counts out.
class EffectBench {
 public:
  static constexpr double kStep = 1e-3;

  explicit EffectBench(const std::string& effects, double coulomb_N = 15.0)
      : robot_(configuredRobot("final")),
        simulation_(robot_, dynamics::loadRobotInertia(robot_),
                    parseSimulationParameters("start_lengths_m: [0.6576, 0.6990, 0.7091, 0.6671]\n"
                                              "axes: [{viscous_N_s_per_m: 150, coulomb_N: " +
                                                  std::to_string(coulomb_N) + "}]\neffects: [" + effects + "]\n",
                                              "bench.yaml"),
                    image_),
        bus_(openImageCards(image_)),
        nominal_(plantOf("final")),
        start_(simulation_.lengths()) {
    if (!bus_->selfTest().passed) throw std::runtime_error("self test");
    if (bus_->writeOutputs(3) != hardware::IoStatus::Ok) throw std::runtime_error("outputs");
    weight_ = holdingForces(nominal_, simulation_.state().pose);
  }

  const RobotSimulation& simulation() const { return simulation_; }
  const mechanism::Lengths& start() const { return start_; }

  /// Forces as they are, without control; reached in a ramp of half the time after pushGently().
  void push(const mechanism::Vector4& forces, double seconds) {
    const mechanism::Vector4 from = pushed_;
    const int steps = static_cast<int>(std::lround(seconds / kStep));
    for (int i = 0; i < steps; ++i) {
      pushed_ = gently_ ? mechanism::Vector4(from + std::min(1.0, 2.0 * i / steps) * (forces - from)) : forces;
      write(pushed_);
      ASSERT_TRUE(simulation_.step(kStep));
    }
  }
  void pushGently() { gently_ = true; }
  /// What holds the robot without friction.
  const mechanism::Vector4& weight() const { return weight_; }

  /// Follows start + offset(t) for `seconds`; every millisecond goes to `look`.
  void follow(double seconds, const std::function<mechanism::Vector4(double)>& offset,
              const std::function<void(const EffectSample&)>& look) {
    for (int i = 0; i < std::lround(seconds / kStep); ++i) {
      EffectSample sample;
      sample.time_s = simulation_.time();
      const double t = i * kStep;
      sample.reference = start_ + offset(t);
      const mechanism::Vector4 wanted_rate = (offset(t + 0.5 * kStep) - offset(t - 0.5 * kStep)) / kStep;
      sample.seen = read();
      const mechanism::Vector4 rate = started_ ? mechanism::Vector4((sample.seen - last_seen_) / kStep)
                                               : mechanism::Vector4(mechanism::Vector4::Zero());
      filtered_rate_ += 0.4 * (rate - filtered_rate_);
      last_seen_ = sample.seen;
      started_ = true;
      integral_ += kStep * (sample.reference - sample.seen);
      sample.force = holdingForces(nominal_, simulation_.state().pose) + 8e4 * (sample.reference - sample.seen) +
                     2e5 * integral_ + 1200.0 * (wanted_rate - filtered_rate_) + 150.0 * wanted_rate;
      write(sample.force);
      const mechanism::Vector4 before = simulation_.state().pose_velocity;
      sample.truth = simulation_.lengths();
      ASSERT_TRUE(simulation_.step(kStep));
      mechanism::Motion motion;
      motion.pose = simulation_.state().pose;
      motion.pose_velocity = simulation_.state().pose_velocity;
      motion.pose_acceleration = (motion.pose_velocity - before) / kStep;
      sample.rates = mechanism::lengthJacobian(nominal_.rigid.mechanism, motion.pose) * motion.pose_velocity;
      mechanism::Vector4 frictionless = mechanism::Vector4::Zero();
      ASSERT_TRUE(dynamics::inverseDynamics(nominal_.rigid, motion, frictionless));
      sample.friction = sample.force - frictionless;
      if (look) look(sample);
    }
  }

  /// Mean friction of `axis` while it moves at `velocity` (m/s, constant) and the others rest where they are: after a
  /// run-up, over 10 mm.
  double frictionAt(int axis, double velocity) {
    double sum = 0.0, load = 0.0;
    int count = 0;
    const double run_up = std::max(0.4, 0.002 / std::abs(velocity)), seconds = run_up + 0.01 / std::abs(velocity);
    follow(
        seconds,
        [&](double t) {
          return mechanism::Vector4(base_ + mechanism::Vector4::Unit(axis) * velocity * std::max(0.0, t));
        },
        [&](const EffectSample& sample) {
          if (sample.time_s - entered_ < run_up) return;
          sum += sample.friction[axis];
          load += sample.force[axis] - sample.friction[axis];
          ++count;
        });
    base_[axis] += velocity * seconds;
    entered_ = simulation_.time();
    load_ = load / count;
    return sum / count;
  }
  /// Mean force of frictionless rigid links during the last frictionAt, N.
  double load() const { return load_; }

 private:
  mechanism::Lengths read() {
    hardware::AxisFeedback feedback;
    if (bus_->read(feedback) != hardware::IoStatus::Ok) throw std::runtime_error("read");
    mechanism::Lengths seen;
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const mechanism::Actuator& actuator = robot_.actuators[static_cast<std::size_t>(i)];
      seen[i] = start_[i] +  // the self test resets the counters
                actuator.encoder_sign * actuator.metresPerCount() *
                    static_cast<double>(static_cast<std::int32_t>(feedback.counts[static_cast<std::size_t>(i)]));
    }
    return seen;
  }
  void write(const mechanism::Vector4& forces) {
    std::array<double, 4> volts{}, written{};
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const mechanism::Actuator& actuator = robot_.actuators[axis];
      volts[axis] = forces[i] / (actuator.force_sign * actuator.force_per_volt_N);
    }
    if (bus_->writeVolts(volts, written) != hardware::IoStatus::Ok) throw std::runtime_error("write");
  }

  mechanism::Robot robot_;
  RobotImage image_;
  RobotSimulation simulation_;
  std::unique_ptr<hardware::AxisBus> bus_;
  PlantModel nominal_;
  mechanism::Lengths start_;
  mechanism::Vector4 weight_ = mechanism::Vector4::Zero(), integral_ = mechanism::Vector4::Zero(),
                     filtered_rate_ = mechanism::Vector4::Zero();
  mechanism::Vector4 base_ = mechanism::Vector4::Zero();
  mechanism::Lengths last_seen_ = mechanism::Lengths::Zero();
  double entered_ = 0.0;
  bool started_ = false, gently_ = false;
  mechanism::Vector4 pushed_ = mechanism::Vector4::Zero();
  double load_ = 0.0;
};

/// A smooth wave of all four legs from rest: `amplitude` (m), `frequency` (Hz).
inline mechanism::Vector4 wave(double t, double amplitude, double frequency) {
  const double angle = 6.283185307179586 * frequency * std::max(0.0, t);
  return mechanism::Vector4::Constant(amplitude * (1.0 - std::cos(angle)));
}

}  // namespace knee_robot::simulation
