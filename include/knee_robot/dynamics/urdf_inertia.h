#pragma once

#include <string>

#include "knee_robot/dynamics/robot_inertia.h"

namespace knee_robot::dynamics {

/// The URDF at `path` with the <inertial> of the nine links replaced (origin in the centre of mass, axes of the link
/// frame); everything else stays. `note` becomes a comment at the top. InputError when the file cannot be read, is no
/// XML, or a link is missing; std::invalid_argument when no body can have one of the inertias: such a file is never
/// written.
std::string urdfWithInertia(const std::string& path, const RobotInertia& inertia, const std::string& note);

/// The same of a chain: every body's inertia (one a joint, in the body's frame) goes to the link that its joint moves;
/// other links of the body lose theirs, which it contains.
std::string urdfWithChainInertia(const std::string& path, const mechanism::Chain& chain,
                                 const std::vector<LinkInertia>& bodies, const std::string& note);

}  // namespace knee_robot::dynamics
