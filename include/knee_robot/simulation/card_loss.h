#pragma once

#include <cstdint>

namespace knee_robot::simulation {

/// How a simulated PCI card is lost: what its image's `disconnected` holds.
enum CardLoss : std::uint8_t {
  kCardThere = 0,
  kCardGone = 1,  ///< the kernel knows: every access fails
  kCardSilent =
      2,  ///< it is plugged in and does not answer (master abort): reads give ones, writes succeed and do nothing
};

}  // namespace knee_robot::simulation
