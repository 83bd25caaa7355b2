#pragma once

#include "knee_robot/control/machine_state.h"
#include "safety_inputs.h"
#include "supervisor_view.h"

namespace knee_robot::control {

/// When a hand may guide the platform, and what ends it. The enabling switch must have been let go of since the drives
/// were enabled and since the last guiding: one that is held down by something else than a hand begins nothing. Pure,
/// real-time safe.
class GuidingPermission {
 public:
  /// What else has to be so.
  struct Conditions {
    bool has_guide = false;      ///< a HandGuide is connected
    bool brakes_tested = false;  ///< all axes have brakes, and they are tested at enabling
    bool ready = false;          ///< components run, encoders and outputs answer
  };

  /// Must outlive this.
  explicit GuidingPermission(const SafetyInputs& inputs) : inputs_(inputs) {}

  /// The controller starts.
  void start() noexcept { stop_ = GuideStop::None; }
  /// Once a cycle.
  void readSwitch(const SupervisorView& view) noexcept;
  /// The drives are being enabled.
  void driversEnabled() noexcept { released_ = false; }
  /// Done: guiding begins with this cycle. Else why it does not; GuideRefused: see stop().
  RequestResult begin(const SupervisorView& view, const Conditions& conditions) noexcept;
  /// One cycle of guiding. False: it is over, because the switch was let go of or for the reason that stop() says.
  bool goesOn(const SupervisorView& view) noexcept;
  /// Why the last guiding was refused, or ended by itself.
  GuideStop stop() const noexcept { return stop_; }

 private:
  const SafetyInputs& inputs_;
  bool held_ = false;      // the enabling switch, now
  bool released_ = false;  // it was let go of
  GuideStop stop_ = GuideStop::None;
};

}  // namespace knee_robot::control
