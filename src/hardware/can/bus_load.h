#pragma once

#include <string>
#include <vector>

namespace knee_robot::hardware::can {

/// Bits of a frame of 11-bit identifier with so many data bytes, with the gap to the next: 47 + 8 n, and with the most
/// stuff bits that its content could need (34 + 8 n bits are stuffed, one bit after each four at worst).
constexpr int frameBits(int data_bytes) noexcept {
  return 47 + 8 * data_bytes;
}
constexpr int longestFrameBits(int data_bytes) noexcept {
  return frameBits(data_bytes) + (34 + 8 * data_bytes - 1) / 4;
}

/// Frames of one kind: so many data bytes, so often a second on the whole bus.
struct Traffic {
  int data_bytes = 0;
  double frames_per_s = 0.0;
};

/// Share of the bit rate that is taken at worst stuffing, 0 to 1 and beyond.
double busLoad(const std::vector<Traffic>& traffic, double bits_per_s);

/// Largest admissible load at worst stuffing: the rest is for service data, emergencies and repeated frames.
inline constexpr double kLargestLoad = 0.85;

/// Throws InputError when the cyclic traffic needs more than kLargestLoad; `where` begins the sentence.
void requireFits(const std::vector<Traffic>& traffic, double bits_per_s, const std::string& where);

}  // namespace knee_robot::hardware::can
