#include "knee_robot/simulation/robot_simulation.h"

#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::simulation {
namespace {

constexpr double kDriveLate_s = 0.1, kHoldLate_s = 0.5;  // of injected faults
constexpr double kCreep_N_s_per_m = 4e4;                 // 100 N: 2.5 mm/s

dynamics::LinkInertia withPayload(const dynamics::LinkInertia& platform, const Payload& payload) {
  dynamics::LinkInertia load;
  load.mass = payload.mass_kg;
  load.center = payload.center_m;
  load.inertia =
      payload.mass_kg * payload.radius_of_gyration_m * payload.radius_of_gyration_m * mechanism::Matrix3::Identity();
  return dynamics::fromParameters(dynamics::toParameters(platform) + dynamics::toParameters(load));
}

PlantModel makeModel(const mechanism::Robot& robot, dynamics::RobotInertia inertia,
                     const SimulationParameters& parameters) {
  if (!robot.mechanism) {
    throw InputError(robot.path + ": mechanism axes cannot be simulated yet; use a robot file of the 3UPS+1RPU");
  }
  mechanism::Lengths shortest;
  mechanism::Lengths longest;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    shortest[i] = robot.actuators[axis].position_min_m - parameters.stop_margin_m;
    longest[i] = robot.actuators[axis].position_max_m + parameters.stop_margin_m;
    inertia.rotor_mass[i] = parameters.axes[axis].rotor_mass_kg;
  }
  if (parameters.payload) {
    inertia.links[dynamics::kPlatformLink] = withPayload(inertia.links[dynamics::kPlatformLink], *parameters.payload);
  }
  PlantModel model(dynamics::RigidModel(*robot.mechanism, robot.gravity, inertia), shortest, longest);
  model.substeps = parameters.substeps;
  return model;
}

mechanism::Pose startPose(const mechanism::Robot& robot, const SimulationParameters& parameters,
                          const PlantModel& model) {
  mechanism::Lengths lengths;
  for (int i = 0; i < mechanism::kLegs; ++i)
    lengths[i] = robot.actuators[static_cast<std::size_t>(i)].home_length_m;
  if (parameters.start_lengths_m) lengths = *parameters.start_lengths_m;
  const std::string source =
      parameters.start_lengths_m ? parameters.path + ": start_lengths_m" : robot.path + ": home_length_m";
  for (int i = 0; i < mechanism::kLegs; ++i) {
    if (lengths[i] < model.shortest_m[i] || lengths[i] > model.longest_m[i]) {
      throw InputError(source + ": leg " + std::to_string(i + 1) + " at " + shortNumber(lengths[i]) +
                       " m is beyond its stops, " + shortNumber(model.shortest_m[i]) + " to " +
                       shortNumber(model.longest_m[i]) + " m");
    }
  }
  const mechanism::ForwardResult found = mechanism::forwardKinematicsFromHome(model.rigid.mechanism, lengths);
  if (!found.ok())
    throw InputError(source + ": the legs cannot have these lengths together; give others as start_lengths_m");
  return found.pose;
}

}  // namespace

bool DelayedSwitch::step(bool input, double dt) noexcept {
  if (input == on_) {
    differing_s_ = 0.0;
    return on_;
  }
  differing_s_ += dt;
  constexpr double kRounding = 1e-9;  // s
  if (differing_s_ + kRounding >= (input ? on_delay_s_ : off_delay_s_)) {
    on_ = input;
    differing_s_ = 0.0;
  }
  return on_;
}

RobotSimulation::RobotSimulation(const mechanism::Robot& robot, dynamics::RobotInertia inertia,
                                 const SimulationParameters& parameters, RobotImage& image)
    : parameters_(parameters),
      model_(makeModel(robot, std::move(inertia), parameters)),
      effects_(parameters.effects, model_),
      image_(image),
      injector_(image.faults),
      heartbeat_age_s_(1e9) {
  state_.pose = startPose(robot, parameters, model_);
  effects_.start(model_, state_);
  for (std::size_t i = 0; i < static_cast<std::size_t>(mechanism::kLegs); ++i) {
    const mechanism::Actuator& actuator = robot.actuators[i];
    const AxisParameters& axis = parameters.axes[i];
    axes_.push_back(Axis{axis, DelayedSwitch(parameters.drive_delay_s, parameters.drive_delay_s),
                         DelayedSwitch(axis.hold_release_delay_s, axis.hold_engage_delay_s),
                         actuator.force_sign * actuator.force_per_volt_N,
                         actuator.encoder_sign / actuator.metresPerCount(), actuator.home_length_m});
  }
  readCards(0.0);
  publish();
}

void RobotSimulation::readCards(double dt) noexcept {
  const InjectedFaults& faults = image_.faults;
  generation_ = faults.generation.load(std::memory_order_acquire);
  const auto asked = other_volts_ != nullptr ? *other_volts_ : outputVolts(image_.analog);
  const auto volts = volts_ = injector_.volts(asked);
  const unsigned outputs = image_.counter.outputs.load(std::memory_order_acquire);
  const bool power = relayIsClosed(outputs, dt) && image_.surroundings.emergency_stop_pressed.load() == 0;
  const bool enable = power && (outputs >> parameters_.drive_enable_bit & 1u) != 0;
  const bool release = power && (outputs >> parameters_.hold_release_bit & 1u) != 0;
  unsigned enabled_bits = 0;
  unsigned engaged_bits = 0;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& axis = axes_[i];
    const int leg = static_cast<int>(i);
    // Without power the force is gone at once; a drive that is switched off by its input takes its delay.
    const auto ordered = [i](const std::atomic<std::uint8_t>& mask) { return (mask.load() >> i & 1u) != 0; };
    const bool enabled = axis.drive.step(enable, dt) && power;
    axis.enabled_s = enabled ? axis.enabled_s + dt : 0.0;
    const bool late = ordered(faults.drive_late) && axis.enabled_s < kDriveLate_s;
    const bool driven = enabled && !late && !ordered(faults.drive_dead);
    const bool off = !axis.release.step(release, dt);
    axis.held_s = off ? axis.held_s + dt : 0.0;
    const bool loose = ordered(faults.hold_open) || (ordered(faults.hold_late) && axis.held_s < kHoldLate_s);
    const bool engaged = ordered(faults.hold_closed) || (off && !loose);
    const double gain = (ordered(faults.drive_reversed) ? -1.0 : 1.0) * (ordered(faults.drive_weak) ? 0.5 : 1.0);
    driven_[leg] = driven ? 1.0 : 0.0;
    loads_.motor_force[leg] = driven ? gain * axis.newtons_per_volt * volts[i] : 0.0;
    const bool creeps = ordered(faults.hold_creeps);
    const bool braked = engaged && axis.parameters.hold_device == SimulatedHold::Brake && !creeps;
    const bool shorted = engaged && axis.parameters.hold_device == SimulatedHold::ShortedWindings;
    holds_.coulomb[leg] = braked ? axis.parameters.holding_force_N : 0.0;
    holds_.viscous[leg] =
        shorted ? axis.parameters.shorted_viscous_N_s_per_m : (engaged && creeps ? kCreep_N_s_per_m : 0.0);
    loads_.viscous[leg] = axis.parameters.viscous_N_s_per_m + holds_.viscous[leg];
    loads_.coulomb[leg] = axis.parameters.coulomb_N + holds_.coulomb[leg];
    loads_.pose_force[leg] = image_.surroundings.pose_force[i].load(std::memory_order_relaxed);
    enabled_bits |= (driven ? 1u : 0u) << i;
    engaged_bits |= (engaged ? 1u : 0u) << i;
  }
  outputs_ = outputs;
  engaged_ = engaged_bits;
  image_.status.drives_enabled.store(static_cast<std::uint8_t>(enabled_bits));
  image_.status.brakes_engaged.store(static_cast<std::uint8_t>(engaged_bits));
  unsigned inputs = (power ? 1u : 0u) << parameters_.emergency_stop_clear_bit;
  if (parameters_.hand_switch_clear_bit && image_.surroundings.hand_switch_pressed.load() == 0) {
    inputs |= 1u << *parameters_.hand_switch_clear_bit;
  }
  if (parameters_.enabling_switch_bit && image_.surroundings.enabling_switch_held.load() != 0) {
    inputs |= 1u << *parameters_.enabling_switch_bit;
  }
  if (parameters_.drives_ready_bit && power && faults.drive_dead.load() == 0)
    inputs |= 1u << *parameters_.drives_ready_bit;
  image_.counter.inputs.store(static_cast<std::uint8_t>(inputs));
}

/// Retriggered by every change of the heartbeat output.
bool RobotSimulation::relayIsClosed(unsigned outputs, double dt) noexcept {
  if (!parameters_.heartbeat_relay) return true;
  const HeartbeatRelay& relay = *parameters_.heartbeat_relay;
  const bool changed = ((outputs ^ outputs_) >> relay.bit & 1u) != 0;
  heartbeat_age_s_ = changed ? 0.0 : heartbeat_age_s_ + dt;
  return heartbeat_age_s_ <= relay.hold_s;
}

void RobotSimulation::publish() noexcept {
  const mechanism::Lengths now = lengths();
  const mechanism::Lengths seen = effects_.encoders(now);
  FaultInjector::Values true_counts{};
  FaultInjector::Values counts_per_m{};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    counts_per_m[i] = axes_[i].counts_per_m;
    true_counts[i] = (seen[static_cast<int>(i)] - axes_[i].home_length_m) * axes_[i].counts_per_m;
  }
  const FaultInjector::Values counts = injector_.counts(true_counts, counts_per_m);
  std::array<std::uint32_t, hardware::kChannels> sums{};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const int leg = static_cast<int>(i);
    sums[i] = static_cast<std::uint32_t>(std::llround(counts[i]));
    image_.status.lengths_m[i].store(now[leg], std::memory_order_relaxed);
    image_.status.pose[i].store(state_.pose[leg], std::memory_order_relaxed);
  }
  publishCounts(image_.counter, sums);
  image_.status.time_s.store(time_s_);
  image_.plant_heartbeat.fetch_add(1, std::memory_order_release);
}

TruthRow RobotSimulation::truth() const noexcept {
  TruthRow row{};
  row.time_s = time_s_;
  const mechanism::Lengths now = lengths();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto leg = static_cast<Eigen::Index>(i);
    row.length_m[i] = now[leg];
    row.pose[i] = state_.pose[leg];
    row.volts[i] = volts_[i];
    row.force_N[i] = loads_.motor_force[leg];
    row.drives |= (driven_[leg] > 0.0 ? 1u : 0u) << i;
  }
  row.outputs = outputs_;
  row.holds = engaged_;
  row.faults = generation_;
  return row;
}

bool RobotSimulation::stepWithEffects(double dt) noexcept {
  PlantLoads own = loads_;
  own.coulomb_asymmetry.setZero();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto leg = static_cast<Eigen::Index>(i);
    own.viscous[leg] = axes_[i].parameters.viscous_N_s_per_m;
    own.coulomb[leg] = axes_[i].parameters.coulomb_N;
  }
  const bool good = effects_.step(model_, own, holds_, driven_, dt, state_, data_);
  loads_ = effects_.acted();
  return good;
}

bool RobotSimulation::step(double dt) noexcept {
  readCards(dt);
  const bool good = effects_.empty() ? stepPlant(model_, loads_, dt, state_, data_) : stepWithEffects(dt);
  time_s_ += dt;
  publish();
  return good;
}

}  // namespace knee_robot::simulation
