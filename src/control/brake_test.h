#pragma once

#include <array>

#include "knee_robot/control/hardware_file.h"

namespace knee_robot::control {

/// Pushes against each engaged holding brake before it is trusted: one axis after the other, shortening first, then
/// lengthening; the force rises for 20 ms, stays for 30 ms, and is gone. Axes without a brake get no force. Pure,
/// real-time safe.
class BrakeTest {
 public:
  /// What one cycle of the test asks for, and what it found.
  struct Step {
    AxisValues force_N{};  ///< to be pushed now
    int slipped = 0;       ///< axis whose brake gave way, 1 to 4; 0: none
    bool done = false;     ///< all brakes hold
  };

  explicit BrakeTest(const HardwareFile& hardware);

  /// The axes stand here, held by their brakes.
  void standAt(const AxisValues& position_m) noexcept { stands_m_ = position_m; }
  /// `time_s` after the test's begin. `force_N` 0: nothing is tested.
  Step step(double time_s, const AxisValues& position_m, double force_N, double slip_m) const noexcept;
  /// All axes have a brake.
  bool coversAllAxes() const noexcept;

 private:
  std::array<bool, hardware::kAxes> has_brake_{};
  AxisValues stands_m_{};
};

}  // namespace knee_robot::control
