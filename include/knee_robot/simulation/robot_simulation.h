#pragma once

#include <vector>

#include "knee_robot/simulation/effect_chain.h"
#include "knee_robot/simulation/fault_injector.h"
#include "knee_robot/simulation/shared_image.h"
#include "knee_robot/simulation/simulation_parameters.h"
#include "knee_robot/simulation/truth_row.h"

namespace knee_robot::simulation {

/// Output that follows its input once that has differed for the delay: a brake, a drive's enable input.
class DelayedSwitch {
 public:
  DelayedSwitch(double on_delay_s, double off_delay_s) : on_delay_s_(on_delay_s), off_delay_s_(off_delay_s) {}
  /// Advances by dt with this input; returns the output.
  bool step(bool input, double dt) noexcept;
  bool on() const noexcept { return on_; }

 private:
  double on_delay_s_;
  double off_delay_s_;
  double differing_s_ = 0.0;
  bool on_ = false;
};

/// The simulated robot: a plant behind card images. Each step reads the analog and digital outputs from the image,
/// moves the plant, and publishes encoder counts, digital inputs and status. The motors are in current mode: volts are
/// force, if the drives are enabled, powered, and their delay is over; else none. The same class is stepped in process
/// (deterministic, as fast as it can) and by the real-time program simulated_robot.
///
/// The encoders count from the robot file's home lengths in its counts per metre, and keep their fraction, as glass
/// scales do.
/// Pressing the emergency stop takes the power from drives and holding brakes, whatever the outputs say; so does the
/// relay on the heartbeat output, where the simulation file has one, when the output has not changed for its time.
/// Faults ordered in the image (simulation/injected_faults.h) are applied to converters, drives, holding brakes and
/// encoders.
class RobotSimulation {
 public:
  /// Throws InputError when the robot is no 3UPS+1RPU, or the start lengths are outside the stroke or belong to no
  /// pose.
  /// `image` must outlive this. The rotor masses of `inertia` are replaced by those of `parameters`.
  RobotSimulation(const mechanism::Robot& robot, dynamics::RobotInertia inertia, const SimulationParameters& parameters,
                  RobotImage& image);

  /// Advances by dt (s). False when the plant left the numbers (massless or not finite): it then stays where it was.
  /// Real-time safe.
  bool step(double dt) noexcept;

  /// Set values from elsewhere than the analog card: from drives on a bus. `volts` must outlive this.
  void takeVoltsFrom(const std::array<double, hardware::kAxes>& volts) noexcept { other_volts_ = &volts; }

  double time() const noexcept { return time_s_; }
  const PlantState& state() const noexcept { return state_; }
  const PlantModel& model() const noexcept { return model_; }
  const PlantData& data() const noexcept { return data_; }
  const PlantLoads& loads() const noexcept { return loads_; }
  /// Mean over the last step of the command less what a robot without effects would need (see EffectChain).
  mechanism::Vector4 unmodelled() const noexcept { return effects_.unmodelled(); }
  /// The last step as a row of the truth log, without its time of the clock.
  TruthRow truth() const noexcept;
  mechanism::Lengths lengths() const { return mechanism::legLengths(model_.rigid.mechanism, state_.pose); }

 private:
  struct Axis {
    AxisParameters parameters;
    DelayedSwitch drive;
    DelayedSwitch release;
    double newtons_per_volt;  ///< signed
    double counts_per_m;      ///< signed
    double home_length_m;
    double enabled_s = 0.0, held_s = 1e9;  ///< since the drive came on, since the brake was ordered to engage
  };

  void readCards(double dt) noexcept;
  bool relayIsClosed(unsigned outputs, double dt) noexcept;
  bool stepWithEffects(double dt) noexcept;
  void publish() noexcept;

  SimulationParameters parameters_;
  PlantModel model_;
  EffectChain effects_;
  PlantState state_;
  PlantData data_;
  PlantLoads loads_;                                        ///< all of them
  mechanism::Vector4 driven_ = mechanism::Vector4::Zero();  ///< 1: the drive is on
  PlantLoads holds_;                                        ///< the share of brakes and shorted windings
  std::vector<Axis> axes_;
  RobotImage& image_;
  FaultInjector injector_;
  FaultInjector::Values volts_{};
  std::uint32_t outputs_ = 0, engaged_ = 0, generation_ = 0;
  double heartbeat_age_s_ = 0.0;
  const std::array<double, hardware::kAxes>* other_volts_ = nullptr;
  double time_s_ = 0.0;
};

}  // namespace knee_robot::simulation
