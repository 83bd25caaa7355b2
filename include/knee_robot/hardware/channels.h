#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/hardware/io_status.h"

namespace knee_robot::hardware {

/// Channels of each of the interfaces below. All of their functions are real-time safe.
inline constexpr int kChannels = 4;

/// Four analog outputs, updated together.
class AnalogOutput {
 public:
  virtual ~AnalogOutput() = default;
  /// As AxisBus::writeVolts.
  virtual IoStatus writeVolts(const std::array<double, kChannels>& volts,
                              std::array<double, kChannels>& written) noexcept = 0;
};

/// Four quadrature counters, latched together.
class EncoderCounter {
 public:
  virtual ~EncoderCounter() = default;
  /// Counts of one instant; `counts` is untouched unless Ok.
  virtual IoStatus readCounts(std::array<std::int32_t, kChannels>& counts) noexcept = 0;
};

/// Four digital outputs, bits 0..3.
class DigitalOutput {
 public:
  virtual ~DigitalOutput() = default;
  virtual IoStatus writeOutputs(std::uint8_t bits) noexcept = 0;
};

/// Four digital inputs, given in bits 0..3.
class DigitalInput {
 public:
  virtual ~DigitalInput() = default;
  virtual IoStatus readInputs(std::uint8_t& bits) noexcept = 0;
};

}  // namespace knee_robot::hardware
