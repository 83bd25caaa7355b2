#pragma once

#include <vector>

namespace knee_robot::dynamics {

/// A ripple has a sine and a cosine per training recording. What another recording has of them: their mean, times the
/// share of it that the training recordings support by agreeing (as tracing's effects/common/ripple.cpp).
std::vector<double> commonPhase(const std::vector<double>& each);

}  // namespace knee_robot::dynamics
