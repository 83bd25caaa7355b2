#pragma once

namespace knee_robot::nodes {

/// Where memory runs out the kernel ends the largest program first, and that is the controller. From here on, and for
/// all that this process starts, others come first. Only root may ask for it (the service manager does it for its
/// services); without a right to it nothing changes.
void endOthersFirst(int adjustment) noexcept;

constexpr int kNever = -1000, kLast = -900;

}  // namespace knee_robot::nodes
