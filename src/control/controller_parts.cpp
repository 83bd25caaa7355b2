#include "controller_parts.h"

#include <algorithm>
#include <cmath>

#include "homing_plan.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/control/component_types.h"
#include "wide_limits.h"

namespace knee_robot::control {
namespace {

AxisValues lengthsAtStart(const mechanism::Robot& robot, const ControlSystem::Options& options) {
  if (options.lengths_at_start_m) return *options.lengths_at_start_m;
  AxisValues lengths{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    lengths[i] = robot.actuators[i].home_length_m;
  return lengths;
}

/// Drives on a bus are told the period, and the bus' load was computed with it.
void requireBusPeriod(const HardwareFile& hardware, const rt::Deployment& deployment, const std::string& path) {
  if (!hardware.can) return;
  for (const auto& activity : deployment.activities()) {
    const double period = rt::toSeconds(activity->options().period);
    if (std::abs(period - hardware.can->period_s) < 1e-9) continue;
    throw InputError(path + ": activity " + activity->name() + " has period_s " + shortNumber(period) + ", and " +
                     hardware.path + " can.period_s " + shortNumber(hardware.can->period_s) +
                     "; one servo cycle is one SYNC: make them equal");
  }
}

/// Lengths a thousand times too small leave each loop without effect, and the platform falls as if no drive were on; a
/// hundred times too small, and a leg that was told to go 10 mm went 400.
void requirePossibleEncoders(const mechanism::Robot& robot, const HardwareFile& hardware) {
  constexpr double kTurns_per_s = 120.0;     // of a screw: 7200 rpm, more than ball screws are made for
  constexpr double kCardCounts_per_s = 8e6;  // encoder inputs up to 2 MHz (Pci1784::Options), four counts each
  constexpr double kCardCounts = 8e4;        // a turn: of encoders with 20000 lines
  for (std::size_t i = 0; i < robot.actuators.size(); ++i) {
    const mechanism::Actuator& a = robot.actuators[i];
    const double turns = a.velocity_max_m_per_s / a.screw_lead_m, counts = turns * a.counts_per_revolution;
    std::string why;
    if (turns > kTurns_per_s)
      why =
          "turn " + shortNumber(turns) + " times in a second, and no screw does more than " + shortNumber(kTurns_per_s);
    else if (!hardware.can && counts > kCardCounts_per_s)
      why = "count " + shortNumber(counts) + " times in a second, and the counter card does " +
            shortNumber(kCardCounts_per_s);
    else if (!hardware.can && a.counts_per_revolution > kCardCounts)
      why = "count " + shortNumber(a.counts_per_revolution) +
            " times in a turn, and no encoder on a card does more than " + shortNumber(kCardCounts);
    if (why.empty()) continue;
    throw InputError(robot.path + ": actuators: at velocity_max_m_per_s " + shortNumber(a.velocity_max_m_per_s) +
                     " axis " + std::to_string(i + 1) + " would " + why +
                     "; correct screw_lead_m (metres) or counts_per_revolution");
  }
}

const mechanism::Robot& requireFourAxes(const mechanism::Robot& robot) {
  if (robot.axes() != hardware::kAxes) {
    throw InputError(robot.path + ": actuators: the controller drives four actuators, not " +
                     std::to_string(robot.axes()));
  }
  return robot;
}

std::unique_ptr<rt::Deployment> deploy(const mechanism::Robot& robot, const HardwareFile& hardware,
                                       const std::string& path, hardware::AxisBus& bus,
                                       const ControlSystem::Options& options) {
  requirePossibleEncoders(robot, hardware);
  if (const std::string why = whyNotHomed(robot, hardware); !why.empty()) throw InputError(hardware.path + ": " + why);
  rt::TypeFactory types = options.types;  // these win
  types.merge(componentTypes(robot, hardware, bus, lengthsAtStart(robot, options)));
  auto deployment = std::make_unique<rt::Deployment>(path, types, options.execution);
  requireBusPeriod(hardware, *deployment, path);
  if (options.cpu) {
    for (const auto& activity : deployment->activities())
      activity->bindTo(*options.cpu);
  }
  return deployment;
}

/// Whom the Supervisor watches, and who tells it of overruns.
void superviseAll(const rt::Deployment& deployment, const MachineComponents& machine) {
  for (const auto& component : deployment.components()) {
    if (component.get() == machine.supervisor) continue;
    component.get() == machine.output ? machine.supervisor->watchOutput(*component)
                                      : machine.supervisor->watch(*component);
  }
  for (const auto& activity : deployment.activities())
    activity->setOverrunHandler([supervisor = machine.supervisor] { supervisor->reportOverrun(); });
}

}  // namespace

ControllerParts::ControllerParts(const mechanism::Robot& given_robot, const HardwareFile& given_hardware,
                                 const std::string& deployment_path, hardware::AxisBus& given_bus,
                                 ControlSystem::Options given_options)
    : robot(requireFourAxes(given_robot)),
      hardware(given_hardware),
      options(std::move(given_options)),
      bus(given_bus),
      deployment(deploy(robot, hardware, deployment_path, bus, options)) {
  superviseAll(*deployment, machine);
  rt::connect(machine.monitors->verdict, heat.verdict);
}

/// Only while disabled.
std::string ControllerParts::whyOccupancyStays() const {
  const MachineState now = report.state();
  if (!started || now == MachineState::Disabled) return "";
  return std::string("not possible while the robot is ") + toString(now) +
         (now == MachineState::Faulted ? "; look at the robot and reset first" : "; disable it first");
}

void ControllerParts::tellOccupancy(Occupancy now, const PatientRange& range) {
  player.halt();    // whatever was asked for before was meant for somebody else,
  player.forget();  // and what is loaded was checked for him
  recordings.setOccupancy(now);
  machine.monitors->setPatient(range);
  if (machine.guide != nullptr) machine.guide->setPatient(range);
  properties.forgetPayloads();
  range.given ? properties.bind() : properties.unbind();
}

PatientChecklist ControllerParts::checklist() const {
  PatientChecklist list(robot, hardware);
  list.monitors_forces = feedforward.monitorsForces();
  list.guarded = bus.isGuarded();
  list.allowed_silence_s = rt::toSeconds(bus.allowedSilence());
  list.lacking_privileges = deployment->warnings();
  list.acceleration_factor = machine.monitors->acceleration_factor;
  list.asks_encoders = std::all_of(machine.drivers.begin(), machine.drivers.end(),
                                   [](const Driver* driver) { return driver->probe_period > 0.0; });
  list.opened_wide = limitsOpenedWide(machine);
  list.strange_weights = feedforward.strangeWeights();
  return list;
}

}  // namespace knee_robot::control
