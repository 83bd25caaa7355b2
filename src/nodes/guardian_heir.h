#pragma once

#include <functional>
#include <memory>

#include "knee_robot/control/guardian.h"

namespace knee_robot::nodes {

/// What hands a load over in place of a guardian that has died.
struct GuardianHeir {
  std::unique_ptr<hardware::EmergencyOutputs> outputs;  ///< its own handle
  control::GuardianCarry carry;
  rt::Nanoseconds silence = 10'000'000;  ///< of the controller, after which it counts as dead
  int priority = 0;                      ///< SCHED_FIFO; 0: none
};

/// In place of a guardian that has died, as the next one would: what it carried, or what a controller has left that has
/// died with it, is handed over to the brakes. Nothing where another guardian lives. Returns when the outputs are down.
void handOverInItsPlace(hardware::GuardianLink& link, hardware::EmergencyOutputs& outputs,
                        const control::GuardianCarry& carry, rt::Nanoseconds silence);

/// Takes `link` for this process, unless another guardian lives that is in it: its number. An heir (below) is waited
/// for, which is about to end.
std::int32_t takeGuard(hardware::GuardianLink& link);

/// A guardian that dies in the middle of a hand-over leaves the drives with the share of the force that they had, and
/// one that dies together with its controller leaves everything on, until somebody starts another one. So a second
/// process waits for the first to end, however it ends, and does handOverInItsPlace() within some milliseconds. It does
/// nothing else: a controller that lives misses its guardian and stops by itself (2 s at most are left to it), and
/// whoever is started next is the guardian. Where guardian and controller stand still together for 0.1 s (three times
/// the silence where that is more) and this process does not, it takes the guardian's place, too; that one ends when it
/// wakes up (Guardian::isReplaced()). Ends when nothing is on any more. `open` is called in that process. Its number;
/// -1: there is none.
std::int32_t keepHeir(hardware::GuardianLink& link, const std::function<GuardianHeir()>& open);

}  // namespace knee_robot::nodes
