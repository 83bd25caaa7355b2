#pragma once

#include <array>

#include "knee_robot/mechanism/geometry.h"

namespace knee_robot::simulation {

/// What the friction (or stop) of one axis does during a step.
enum class AxisContact {
  Held,    ///< the axis ends the step at rest; the impulse is whatever that takes, inside its bounds
  AtLow,   ///< the impulse is at its lower bound: the axis moves in positive direction
  AtHigh,  ///< the impulse is at its upper bound: the axis moves in negative direction
};
using AxisContacts = std::array<AxisContact, mechanism::kLegs>;

/// Bounds of the impulses (N s) along the axes during one step: low <= 0 <= high. Coulomb friction F for dt seconds: -F
/// dt and F dt. A stop at the short end adds an infinite upper bound, one at the long end an infinite lower bound. Both
/// zero: nothing.
struct ImpulseBox {
  mechanism::Vector4 low = mechanism::Vector4::Zero();
  mechanism::Vector4 high = mechanism::Vector4::Zero();
};

/// Friction at velocity level (maximal dissipation): impulses p in the box such that with w = velocity + mobility p
/// each axis either rests (w = 0), or moves with p at the bound that opposes it.
///
/// `mobility` is J A^-1 J^T (m/s per N s, positive definite), `velocity` the axes' velocities without friction (m/s).
/// `contacts` goes in as the guess (last step's) and comes out as found. Exact, by enumeration of the at most 81
/// combinations (the guess first); when rounding leaves no combination without contradiction, the one with the smallest
/// is taken.
/// Returns p. Real-time safe, bounded.
mechanism::Vector4 solveBoxFriction(const mechanism::Matrix4& mobility, const mechanism::Vector4& velocity,
                                    const ImpulseBox& box, AxisContacts& contacts);

}  // namespace knee_robot::simulation
