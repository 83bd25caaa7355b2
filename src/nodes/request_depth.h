#pragma once

namespace knee_robot::nodes {

/// roscpp reads values within values by a call within a call: one request of a few megabytes, which needs no permission,
/// takes all of a thread's stack and so ends the process. A program that calls this reads values nested at most
/// kDeepestRequest times; a deeper request is answered as one that cannot be read. ROS itself nests three or four.
void limitRequestDepth();

inline constexpr int kDeepestRequest = 100;

}  // namespace knee_robot::nodes
