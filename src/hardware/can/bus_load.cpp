#include "bus_load.h"

#include <cstdio>

#include "knee_robot/base/errors.h"

namespace knee_robot::hardware::can {

double busLoad(const std::vector<Traffic>& traffic, double bits_per_s) {
  double bits = 0.0;
  for (const Traffic& kind : traffic)
    bits += longestFrameBits(kind.data_bytes) * kind.frames_per_s;
  return bits / bits_per_s;
}

void requireFits(const std::vector<Traffic>& traffic, double bits_per_s, const std::string& where) {
  const double load = busLoad(traffic, bits_per_s);
  if (load <= kLargestLoad) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "the cyclic frames take %.0f %% of %.0f kbit/s, more than %.0f %%; lengthen period_s or raise bit_rate",
                100.0 * load, bits_per_s / 1000.0, 100.0 * kLargestLoad);
  throw InputError(where + text);
}

}  // namespace knee_robot::hardware::can
