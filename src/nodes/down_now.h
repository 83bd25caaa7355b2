#pragma once

#include <string>

#include "knee_robot/hardware/guardian_link.h"

/// What `guardian --down-now` finds on the machine, and what it waits for before it brings the outputs down.
namespace knee_robot::nodes {

/// A guardian that is in this link lives and goes round.
bool guardianActs(const hardware::GuardianLink& link);

/// A controller that lives notices within 50 ms that its guardian is gone, and stops as it should: along the path, the
/// load handed over to the brakes. Waits for that, 1.5 s at most. False: it goes on living with its drives on (a brake
/// does not hold, and they carry the platform).
bool letControllerStop(const hardware::GuardianLink& link);

/// Two cycles of the guardian that lives, 0.2 s at most: then it has seen the fence, and acts.
void letGuardianSee(const hardware::GuardianLink& link);

/// A controller has this machine and is not in `link` (none: nullptr): its own is one of another version of this package,
/// or somebody has removed the name. It cannot be fenced out, and writes again what it likes. Where only a guardian is
/// such a stranger, it may be handing over what its controller left: that is waited for.
bool isBesideAStranger(const hardware::GuardianLink* link, const std::string& machine);

}  // namespace knee_robot::nodes
