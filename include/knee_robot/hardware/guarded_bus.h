#pragma once

#include <string>

#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/emergency_outputs.h"
#include "knee_robot/hardware/guardian_link.h"

namespace knee_robot::hardware {

/// CLOCK_MONOTONIC in ns.
std::int64_t monotonicTime() noexcept;

/// The controller's bus while a guardian watches: passes everything on, tells the guardian that the controller lives
/// and whether drives are on, and refuses every write (FencedOut) from the moment at which the guardian has acted until
/// reclaim(). The watch is mutual: a guardian that falls silent is a failure of this bus.
///
/// A controller that was stopped between the look at the fence and the write behind it, and comes back, still gets that
/// one write through: the guardian's next cycle takes it back.
class GuardedBus : public AxisBus {
 public:
  /// What the guarded bus needs besides the bus.
  struct Options {
    EmergencyOutputs* outputs =
        nullptr;  ///< what brings the outputs down before anything else; none: the bus' self test does
    std::int64_t guardian_silence_ns = 50'000'000;  ///< a guardian that does not cycle for so long is dead
    std::int64_t (*clock)() noexcept = monotonicTime;
    std::uint64_t machine = 0;  ///< machineMark() that the guardian has to have, too; 0: not compared
    std::uint64_t wiring = 0;   ///< the same of outputs and brakes
  };

  /// All must outlive this. `power_bits`: digital outputs that enable drives or release holding brakes.
  GuardedBus(AxisBus& bus, GuardianLink& link, std::uint8_t power_bits, Options options);
  GuardedBus(AxisBus& bus, GuardianLink& link, std::uint8_t power_bits)
      : GuardedBus(bus, link, power_bits, Options()) {}

  /// Before a guardian is waited for: this process takes the robot unless another controller lives, and brings the
  /// outputs down; where a guardian is handing a dead controller's load over to the brakes, after that.
  /// Empty, or why not. Not real-time.
  std::string takeOver();
  /// Fails when another controller lives: nothing is touched then. Otherwise the outputs go down before the guardian is
  /// asked for them; fails when it does not answer, or guards another machine. Takes a guardian's latch back: the
  /// drives are off.
  SelfTest selfTest() override;
  IoStatus read(AxisFeedback& feedback) noexcept override;
  IoStatus writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept override;
  IoStatus writeOutputs(std::uint8_t bits) noexcept override;
  bool isFencedOut() const noexcept override;
  bool isGuarded() const noexcept override { return true; }
  std::int64_t allowedSilence() const noexcept override;
  bool stopsByItself() const noexcept override { return bus_.stopsByItself(); }
  void offerLoad(const std::array<double, kAxes>* volts) noexcept override;
  void watchBrakes(const BrakeWatch& watch) noexcept override;
  bool isCarriedByGuardian() const noexcept override;
  /// Waits up to 0.3 s for the guardian; while that hands the load over to the brakes, up to 3 s.
  IoStatus reclaim() override;
  /// GuardianSilent from guardian_silence_ns without a cycle of the guardian on, counted in read().
  BusFailure failure() const noexcept override;
  void acknowledgeFaults() noexcept override { bus_.acknowledgeFaults(); }

 private:
  static constexpr std::int64_t kLongestStep_ns = 4'000'000;  // twice the slowest servo period

  std::int32_t claim() noexcept;
  void listen() noexcept;

  AxisBus& bus_;
  GuardianLink& link_;
  const std::uint8_t power_bits_;
  const Options options_;
  std::uint64_t guardian_cycles_ = 0;
  std::int64_t last_read_ns_ = 0;
  std::int64_t silence_ns_ = 0;
};

}  // namespace knee_robot::hardware
