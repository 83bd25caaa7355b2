#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "knee_robot/hardware/brake_watch.h"
#include "knee_robot/hardware/bus_failure.h"
#include "knee_robot/hardware/io_status.h"

namespace knee_robot::hardware {

/// Axes of one bus: as many as the analog card has outputs and the counter card has counters.
inline constexpr int kAxes = 4;

/// What one read() brings.
struct AxisFeedback {
  std::array<std::int32_t, kAxes> counts{};  ///< encoder counts, latched at one instant; take differences as int32
  std::uint8_t digital_inputs = 0;           ///< bits 0..3
};

/// Difference of two counter readings across the wrap of int32: right as long as less than 2^31 counts lie between
/// them.
constexpr std::int32_t countDifference(std::int32_t later, std::int32_t earlier) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(later) - static_cast<std::uint32_t>(earlier));
}

/// Result of a self test: `findings` holds one sentence a step, passed or not; the last one says why it stopped.
struct SelfTest {
  bool passed = false;
  std::vector<std::string> findings;
};

/// Four motor axes: set values out, encoder counts and digital inputs in. The only thing of the hardware that control/
/// knows; cards, simulator and CAN drives are behind it. One thread uses a bus at a time.
///
/// read, writeVolts and writeOutputs are real-time safe (bounded time, no allocation, no lock, no throw). Nothing
/// zeroes the outputs when a bus is destroyed or its process dies: they hold their last value until somebody writes
/// another.
class AxisBus {
 public:
  virtual ~AxisBus() = default;

  /// Not real-time, no motion: brings the device to its safe state (all digital outputs 0, so drives off and brakes on;
  /// 0 V on all channels; counters 0) and checks that it is there and answers. Until it has passed, writeVolts and
  /// writeOutputs return NotReady.
  virtual SelfTest selfTest() = 0;

  /// Latches the four counters at one instant and reads them with the digital inputs. `feedback` is untouched unless
  /// Ok.
  virtual IoStatus read(AxisFeedback& feedback) noexcept = 0;

  /// Set values in V, updated on the four channels simultaneously. `written` is what the converter got, after clamping
  /// to its range and quantization. A value that is not finite refuses the whole command: nothing is written, outputs
  /// stay, `written` is untouched. After Disconnected or DeviceError the outputs may be anything: stop by other means.
  virtual IoStatus writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept = 0;

  /// Sets all digital outputs, bits 0..3; a higher bit is OutOfRange.
  virtual IoStatus writeOutputs(std::uint8_t bits) noexcept = 0;

  /// True while somebody else has taken the outputs (GuardedBus): every write is refused. Real-time safe.
  virtual bool isFencedOut() const noexcept { return false; }

  /// True when the device engages the holding brakes by itself as soon as nobody reaches it: drives that miss a
  /// heartbeat.
  virtual bool stopsByItself() const noexcept { return false; }

  /// True when a process of its own brings the outputs down if this one dies (GuardedBus).
  virtual bool isGuarded() const noexcept { return false; }
  /// The longest silence that one of the two allows the other, ns; 0: nobody watches.
  virtual std::int64_t allowedSilence() const noexcept { return 0; }

  /// What carries the load at this place while the holding brakes are open, V; nullptr: nothing does. For whoever
  /// brings the outputs down if this process dies (GuardedBus). Real-time safe.
  virtual void offerLoad(const std::array<double, kAxes>* /*volts*/) noexcept {}

  /// How whoever takes the load from there finds a brake that does not hold (GuardedBus). Not real-time.
  virtual void watchBrakes(const BrakeWatch& /*watch*/) noexcept {}

  /// True while somebody else has taken the outputs and still lets the drives carry the load (GuardedBus).
  virtual bool isCarriedByGuardian() const noexcept { return false; }

  /// Not real-time, from any thread, with the drives off: asks for the outputs again. FencedOut: not given back.
  virtual IoStatus reclaim() { return IoStatus::Ok; }

  /// Why the machine has to stop although calls may still answer Ok; of the last read(). Real-time safe. Cards know
  /// nothing of it.
  virtual BusFailure failure() const noexcept { return {}; }

  /// From any thread, with the drives off: the operator has asked for a reset. Drives that are in Fault are to be taken
  /// out of it in the next cycles.
  virtual void acknowledgeFaults() noexcept {}
};

}  // namespace knee_robot::hardware
