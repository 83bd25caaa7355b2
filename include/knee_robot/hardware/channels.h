#pragma once

namespace knee_robot::hardware {

/// Of a card: analog outputs, counters, digital inputs and outputs; one of each an axis.
inline constexpr int kChannels = 4;

}  // namespace knee_robot::hardware
