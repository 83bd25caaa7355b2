#include "friction_simplest.h"

#include "friction_families.h"

namespace knee_robot::identification {
namespace {

/// A simpler family is taken when it is within so many standard errors of the best. One would be usual; on the physical
/// robot it keeps the single stop, whose error on another path is up to half as large again (docs/identification.md).
constexpr double kWithinErrors = 0.25;
/// The same where a whole spectrum is the best: with that many shares it comes near to any law.
constexpr double kWithinErrorsOfSpectrum = 1.0;
/// A sum of more than these comes as near to any law, and a spectrum of stops is taken for it when it is as near: brisk
/// training does not tell them apart, and what bristles lose at rest stops hold.
constexpr std::size_t kPair = 2;
/// But not when it leaves so many times what the spectrum leaves: few blocks may hold all of the difference, and its
/// standard error with it. Bristles in place of a spectrum of stops let go at rest, where brisk training hardly is.
constexpr double kNearSpectrum = 1.1;

}  // namespace

bool inPlaceOf(long best, std::size_t elements_of_best, long family, const Worse& worse, double times) {
  const bool as_near = worse.mean <= kWithinErrorsOfSpectrum * worse.standard_error && times <= kNearSpectrum;
  if (isSpectrum(best)) return as_near;
  if (worse.mean <= kWithinErrors * worse.standard_error) return true;
  return elements_of_best > kPair && family == kAllStops && as_near;
}

}  // namespace knee_robot::identification
