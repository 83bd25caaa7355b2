#pragma once

#include <string>

namespace knee_robot::control {

/// When something was, as far as a later start of the program can tell.
struct Moment {
  double wall_s = 0.0;        ///< since 1970; anybody may set this clock
  double since_boot_s = 0.0;  ///< of the computer, with the time asleep
  std::string boot;           ///< which boot that was; empty: not known
  bool synchronized = false;  ///< a time server keeps the wall clock; setting it by hand ends that
};

Moment momentNow();

/// How much later `now` is, at least, s. Within one boot: what went by since then, whatever happened to the wall clock.
/// After another boot: this boot has lasted until now, so much is sure; more only by wall clocks that a time server kept
/// at both moments. Where one of the boots is not known, the two may be the same: what the wall clock says, this boot's
/// duration at most.
double leastSecondsBetween(const Moment& then, const Moment& now);

}  // namespace knee_robot::control
