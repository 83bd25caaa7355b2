#pragma once

#include "component_watch.h"
#include "fault_latch.h"
#include "knee_robot/mechanism/robot.h"
#include "safety_inputs.h"
#include "supervisor_view.h"

namespace knee_robot::control {

/// Finds what is wrong with the machine in one cycle. One cause makes many things look wrong at once; what is named is
/// the first one in the order of causes: the guardian, somebody's hand, the drives, the bus, a component, the
/// measurement, the monitors, the Drivers, the outputs, the time. Pure, real-time safe.
class FaultSearch {
 public:
  /// What the Supervisor's properties and state say.
  struct Conditions {
    double range_margin_m = 0.0;  ///< beyond the axes' range before it is a fault
    int stale_cycles = 3;         ///< without encoders, or without a verdict
    bool homed = false;           ///< the lengths mean something
    bool disabled = false;        ///< components may stand
    bool overrun = false;         ///< an activity reported one
  };

  /// Both must outlive this.
  FaultSearch(const mechanism::Robot& robot, const SafetyInputs& inputs, const ComponentWatch& components)
      : robot_(robot), inputs_(inputs), components_(components) {}

  /// The first fault in the order of causes; Fault::None: all is well.
  FaultCause find(const SupervisorView& view, const Conditions& conditions) const noexcept;
  /// Why a safe stop cannot end, whatever began it: a brake slips, or brakes and drives can be ordered nothing any more.
  FaultCause inSafeStop(const SupervisorView& view) const noexcept;
  /// Who has the machine in this cycle, whatever else is wrong: the guardian its outputs, or the emergency stop its
  /// power; Fault::None: the controller.
  Fault machineTaken(const SupervisorView& view) const noexcept;
  /// Whether the cause of `latched` (or another one that would stop at once) is still there: it is not reset then.
  bool causeRemains(Fault latched, const SupervisorView& view) const noexcept;

 private:
  FaultCause inMeasurement(const SupervisorView& view, const Conditions& conditions) const noexcept;
  FaultCause ofMonitors(const SupervisorView& view, const Conditions& conditions) const noexcept;

  const mechanism::Robot& robot_;
  const SafetyInputs& inputs_;
  const ComponentWatch& components_;
};

}  // namespace knee_robot::control
