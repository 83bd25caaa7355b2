#pragma once

#include "fault_latch.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/control/machine_state.h"
#include "knee_robot/mechanism/robot.h"
#include "supervisor_view.h"

namespace knee_robot::control {

/// Which axes know where they are, and how they learn it (HomingMethod): by hand, or one after the other by their
/// Drivers (HomingMove).
/// While axes move nothing is shifted: no loop ever sees a jump. Pure, real-time safe.
class HomingSequence {
 public:
  enum class Progress { Running, Found, Failed };
  /// What a home without movement came to.
  struct Taken {
    RequestResult result = RequestResult::Done;
    int axis = 0;             ///< HomeShifted: 1 to 4
    double distance_m = 0.0;  ///< HomeShifted
    bool shifts = false;      ///< setting() is new
  };

  HomingSequence(const mechanism::Robot& robot, const HardwareFile& hardware);

  const std::array<bool, hardware::kAxes>& homed() const noexcept { return homed_; }
  bool isHomed() const noexcept;
  /// The controller starts; what the axes know is kept. Assumed: the robot stands at home at the `first` start.
  void start(bool first) noexcept;
  /// The counts of axis `i` (0 to 3) mean nothing any more.
  void forget(std::size_t i) noexcept { homed_[i] = false; }

  /// The hardware file leaves the place to the operator (ConfirmHome); otherwise it is asked for by Home.
  bool isPlacedByHand() const noexcept { return homing_.method == HomingMethod::HandPlaced; }
  bool moves() const noexcept { return homing_.moves(); }
  /// The robot stands at its home lengths now. Refused where the counter of an axis that is still homed says that it is
  /// far from where it was first taken for home, however many small steps led there.
  Taken takeForHome(const AxisValues& measured_m) noexcept;

  /// The enabling that begins now leads to the search, or not.
  void prepare(bool search) noexcept;
  bool isPrepared() const noexcept { return prepared_; }
  /// The drives carry the platform: the search begins.
  void begin(rt::Nanoseconds now) noexcept { since_ = now; }
  /// One cycle of the search: one axis after the other, each when the platform is at rest. Failed: at failedAxis().
  Progress step(const SupervisorView& view, rt::Nanoseconds now) noexcept;
  int failedAxis() const noexcept { return homing_.order[step_]; }
  /// Bit i: the Driver of axis i + 1 is searching.
  std::uint8_t searching() const noexcept;
  /// The drives are off. True: all axes were found and no fault came, setting() is new. Otherwise nothing has changed.
  bool end(bool faulted) noexcept;
  /// For AxesInput.
  const HomeSetting& setting() const noexcept { return setting_; }

 private:
  bool isQuiet(const AxisValues& measured_m, rt::Nanoseconds now) noexcept;
  void shift(const AxisValues& lengths_m, const AxisValues& measured_m) noexcept;

  const HardwareFile::Homing homing_;
  AxisValues home_lengths_m_{};
  std::array<bool, hardware::kAxes> homed_{};
  AxisValues shifted_m_{};  // since the axis was homed anew, all that was confirmed together
  bool prepared_ = false;
  bool found_ = false;         // the safe stop that runs is the search's end
  std::size_t step_ = 0;       // in the order of axes
  bool axis_begun_ = false;    // its Driver has been asked
  rt::Nanoseconds since_ = 0;  // of rest, or of the search's begin
  AxisValues quiet_m_{};       // where the axes rest before the next one begins
  AxisValues found_m_{};
  HomeSetting setting_;
};

}  // namespace knee_robot::control
