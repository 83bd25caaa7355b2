#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "knee_robot/simulation/simulated_cards.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "test/simulation/plant_bench.h"

namespace knee_robot {

/// One millisecond as the controller's side knows it: what it commanded, what its encoders say; and the simulator's truth.
struct EffectSample {
  double time_s = 0.0;
  Lengths reference = Lengths::Zero(), seen = Lengths::Zero(), truth = Lengths::Zero();
  Vector4 rates = Vector4::Zero();  ///< true ones, m/s
  Vector4 force = Vector4::Zero();  ///< commanded, N
  Vector4 friction =
      Vector4::Zero();  ///< commanded force minus that of frictionless rigid links and rotors along the true motion
};

/// A simulated robot with effects, moved along lengths by a stiff position controller through its cards: volts in, counts out.
class EffectBench {
 public:
  static constexpr double kStep = 1e-3;

  explicit EffectBench(const std::string& effects, double coulomb_N = 15.0)
      : robot_(configuredRobot("final")),
        simulation_(robot_, loadRobotInertia(robot_),
                    parseSimulationParameters("start_lengths_m: [0.6576, 0.6990, 0.7091, 0.6671]\n"
                                              "axes: [{viscous_N_s_per_m: 150, coulomb_N: " +
                                                  std::to_string(coulomb_N) + "}]\neffects: [" + effects + "]\n",
                                              "bench.yaml"),
                    image_),
        bus_(hardware::openImageCards(image_)),
        nominal_(plantOf("final")),
        start_(simulation_.lengths()) {
    if (!bus_->selfTest().passed) throw std::runtime_error("self test");
    if (bus_->writeOutputs(3) != hardware::IoStatus::Ok) throw std::runtime_error("outputs");
    weight_ = holdingForces(nominal_, simulation_.state().pose);
  }

  const RobotSimulation& simulation() const { return simulation_; }
  const Lengths& start() const { return start_; }

  /// Forces as they are, without control; reached in a ramp of half the time after pushGently().
  void push(const Vector4& forces, double seconds) {
    const Vector4 from = pushed_;
    const int steps = static_cast<int>(std::lround(seconds / kStep));
    for (int i = 0; i < steps; ++i) {
      pushed_ = gently_ ? Vector4(from + std::min(1.0, 2.0 * i / steps) * (forces - from)) : forces;
      write(pushed_);
      ASSERT_TRUE(simulation_.step(kStep));
    }
  }
  void pushGently() { gently_ = true; }
  /// What holds the robot without friction.
  const Vector4& weight() const { return weight_; }

  /// Follows start + offset(t) for `seconds`; every millisecond goes to `look`.
  void follow(double seconds, const std::function<Vector4(double)>& offset,
              const std::function<void(const EffectSample&)>& look) {
    for (int i = 0; i < std::lround(seconds / kStep); ++i) {
      EffectSample sample;
      sample.time_s = simulation_.time();
      const double t = i * kStep;
      sample.reference = start_ + offset(t);
      const Vector4 wanted_rate = (offset(t + 0.5 * kStep) - offset(t - 0.5 * kStep)) / kStep;
      sample.seen = read();
      const Vector4 rate = started_ ? Vector4((sample.seen - last_seen_) / kStep) : Vector4(Vector4::Zero());
      filtered_rate_ += 0.4 * (rate - filtered_rate_);
      last_seen_ = sample.seen;
      started_ = true;
      integral_ += kStep * (sample.reference - sample.seen);
      sample.force = holdingForces(nominal_, simulation_.state().pose) + 8e4 * (sample.reference - sample.seen) +
                     2e5 * integral_ + 1200.0 * (wanted_rate - filtered_rate_) + 150.0 * wanted_rate;
      write(sample.force);
      const Vector4 before = simulation_.state().pose_velocity;
      sample.truth = simulation_.lengths();
      ASSERT_TRUE(simulation_.step(kStep));
      Motion motion;
      motion.pose = simulation_.state().pose;
      motion.pose_velocity = simulation_.state().pose_velocity;
      motion.pose_acceleration = (motion.pose_velocity - before) / kStep;
      sample.rates = lengthJacobian(nominal_.rigid.mechanism, motion.pose) * motion.pose_velocity;
      Vector4 frictionless = Vector4::Zero();
      ASSERT_TRUE(inverseDynamics(nominal_.rigid, motion, frictionless));
      sample.friction = sample.force - frictionless;
      if (look) look(sample);
    }
  }

  /// Mean friction of `axis` while it moves at `velocity` (m/s, constant) and the others rest where they are: after a run-up,
  /// over 10 mm.
  double frictionAt(int axis, double velocity) {
    double sum = 0.0, load = 0.0;
    int count = 0;
    const double run_up = std::max(0.4, 0.002 / std::abs(velocity)), seconds = run_up + 0.01 / std::abs(velocity);
    follow(
        seconds, [&](double t) { return Vector4(base_ + Vector4::Unit(axis) * velocity * std::max(0.0, t)); },
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
  Lengths read() {
    hardware::AxisFeedback feedback;
    if (bus_->read(feedback) != hardware::IoStatus::Ok) throw std::runtime_error("read");
    Lengths seen;
    for (int i = 0; i < kLegs; ++i) {
      const Actuator& actuator = robot_.actuators[static_cast<std::size_t>(i)];
      seen[i] = start_[i] +  // the self test resets the counters
                actuator.encoder_sign * actuator.metresPerCount() *
                    static_cast<double>(static_cast<std::int32_t>(feedback.counts[static_cast<std::size_t>(i)]));
    }
    return seen;
  }
  void write(const Vector4& forces) {
    std::array<double, 4> volts{}, written{};
    for (int i = 0; i < kLegs; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const Actuator& actuator = robot_.actuators[axis];
      volts[axis] = forces[i] / (actuator.force_sign * actuator.force_per_volt_N);
    }
    if (bus_->writeVolts(volts, written) != hardware::IoStatus::Ok) throw std::runtime_error("write");
  }

  Robot robot_;
  hardware::RobotImage image_;
  RobotSimulation simulation_;
  std::unique_ptr<hardware::AxisBus> bus_;
  PlantModel nominal_;
  Lengths start_;
  Vector4 weight_ = Vector4::Zero(), integral_ = Vector4::Zero(), filtered_rate_ = Vector4::Zero();
  Vector4 base_ = Vector4::Zero();
  Lengths last_seen_ = Lengths::Zero();
  double entered_ = 0.0;
  bool started_ = false, gently_ = false;
  Vector4 pushed_ = Vector4::Zero();
  double load_ = 0.0;
};

/// A smooth wave of all four legs from rest: `amplitude` (m), `frequency` (Hz).
inline Vector4 wave(double t, double amplitude, double frequency) {
  const double angle = 6.283185307179586 * frequency * std::max(0.0, t);
  return Vector4::Constant(amplitude * (1.0 - std::cos(angle)));
}

}  // namespace knee_robot
