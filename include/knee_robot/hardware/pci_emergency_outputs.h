#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/hardware/channels.h"
#include "knee_robot/hardware/io_status.h"
#include "knee_robot/hardware/register_access.h"

// What an EmergencyOutputs does with the two PCI cards: another card has functions of its own.

namespace knee_robot::hardware {

/// Whether the card with the digital outputs answers at all: a write to one that does not succeeds. Real-time safe.
IoStatus outputsPresence(RegisterAccess& counter) noexcept;

/// Brings the outputs of both cards down, through registers alone: no self test before it, nothing remembered,
/// counters untouched. In this order, without waiting:
///   1. all digital outputs 0: the holding brakes engage and the drives are disabled. One write,
///      since they are bits of one port.
///   2. 0 V on the four channels together, in the +-10 V range.
///   3. reads whether the card with the outputs is there at all: a write to one that is not succeeds.
/// A write that fails does not keep the next ones from being tried; answers the first failure. Writing it again changes
/// nothing.
/// Real-time safe.
IoStatus forceDown(RegisterAccess& analog, RegisterAccess& counter) noexcept;

/// Writes these digital outputs, then these volts (finite; clamped to +-10 V) to the four channels together, through
/// registers alone as forceDown(), failures likewise: with the drives' bit alone the holding brakes engage while the
/// drives give what carries the load until they hold. Real-time safe.
IoStatus forceCarry(RegisterAccess& analog, RegisterAccess& counter, std::uint8_t bits,
                    const std::array<double, kChannels>& volts) noexcept;

/// The four counters, latched at one instant, of a card that is there; nothing else of it changes. Real-time safe.
IoStatus latchedCounts(RegisterAccess& counter, std::array<std::int32_t, kChannels>& counts) noexcept;

}  // namespace knee_robot::hardware
