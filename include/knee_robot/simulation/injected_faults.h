#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace knee_robot::simulation {

/// What goes wrong in one encoder of the simulated robot.
enum class EncoderFault : std::uint8_t {
  None,
  Frozen,        ///< stays at the count at which the fault came
  Jump,          ///< counts on, `encoder_size_m` beside the truth
  WrongSign,     ///< counts backwards from where the fault came
  Noise,         ///< uniform noise of +- `encoder_size_m` on every sample
  Disconnected,  ///< open inputs of the card: stands where the fault came and dithers by two counts
  Interrupted,   ///< dithers by +- `encoder_size_m` and counts on from there when it is taken back: what was missed
                 ///< stays missed
};

/// Faults that a test or a fault campaign orders from the simulated robot (program inject_fault). All zero: none. Lies
/// in the robot's image; the simulated robot applies them to its encoders, converters, drives and holding brakes each
/// step, so that the controller meets them as it would on a real machine. Bit a of a mask is axis a.
struct InjectedFaults {
  static constexpr std::size_t kChannelsOfFaults = 4;

  std::array<std::atomic<std::uint8_t>, kChannelsOfFaults> encoder{};  ///< EncoderFault
  std::array<std::atomic<double>, kChannelsOfFaults> encoder_size_m{};
  std::atomic<std::uint8_t> converter_stuck{0};   ///< mask: the voltage stays what it was when the fault came
  std::atomic<std::uint8_t> drive_dead{0};        ///< mask: the drive has no power; only its ready output tells
  std::atomic<std::uint8_t> drive_reversed{0};    ///< mask: the force has the wrong sign
  std::atomic<std::uint8_t> drive_weak{0};        ///< mask: half of the force
  std::atomic<std::uint8_t> drive_late{0};        ///< mask: no force for 0.1 s after its delay, each time it is enabled
  std::atomic<std::uint8_t> hold_open{0};         ///< mask: the holding brake does not engage
  std::atomic<std::uint8_t> hold_closed{0};       ///< mask: the holding brake is engaged whatever its output says
  std::atomic<std::uint8_t> hold_late{0};         ///< mask: the holding brake engages 0.5 s later than it should
  std::atomic<std::uint8_t> hold_creeps{0};       ///< mask: the engaged holding brake gives way slowly
  std::atomic<std::uint32_t> component_fault{0};  ///< for components of test programs; the simulated robot ignores it
  std::atomic<std::uint8_t> can_silent{0};  ///< mask, CAN drives only, like the next: the drive is cut off the bus
  std::atomic<std::uint8_t> can_no_heartbeat{0};  ///< mask: the drive's heartbeat stays away
  std::atomic<std::uint8_t> can_fault{0};         ///< mask: the drive goes to Fault (over-current)
  std::atomic<std::uint8_t> can_emergency{0};     ///< mask: the drive sends an emergency (over-temperature) and goes on
  std::atomic<std::uint8_t> can_wire{0};          ///< hardware::can::WireFault
  std::atomic<std::uint8_t> can_hung_up{0};       ///< the interface is gone: a simulated bus hangs up on everybody
  std::atomic<std::uint32_t> generation{0};       ///< counts orders; written after the order, noted in the truth log
};

/// Takes all faults back. `generation` goes on.
inline void clear(InjectedFaults& faults) noexcept {
  for (auto& one : faults.encoder)
    one.store(static_cast<std::uint8_t>(EncoderFault::None));
  for (auto* mask :
       {&faults.converter_stuck, &faults.drive_dead, &faults.drive_reversed, &faults.drive_weak, &faults.drive_late,
        &faults.hold_open, &faults.hold_closed, &faults.hold_late, &faults.hold_creeps, &faults.can_silent,
        &faults.can_no_heartbeat, &faults.can_fault, &faults.can_emergency, &faults.can_wire, &faults.can_hung_up})
    mask->store(0);
  faults.component_fault.store(0);
  faults.generation.fetch_add(1);
}

}  // namespace knee_robot::simulation
