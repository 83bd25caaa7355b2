#include "knee_robot/simulation/box_friction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace knee_robot::simulation {
namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-12;  // relative to the impulse that would stop the axis

bool isFree(const ImpulseBox& box, int axis) {
  return box.low[axis] == 0.0 && box.high[axis] == 0.0;
}

/// Impulses under the assumption `contacts`.
mechanism::Vector4 impulsesFor(const mechanism::Matrix4& mobility, const mechanism::Vector4& velocity,
                               const ImpulseBox& box, const AxisContacts& contacts) {
  mechanism::Matrix4 system = mechanism::Matrix4::Identity();
  mechanism::Vector4 right = mechanism::Vector4::Zero();
  bool any_held = false;
  for (int axis = 0; axis < mechanism::kLegs; ++axis) {
    const AxisContact contact = contacts[static_cast<std::size_t>(axis)];
    if (contact == AxisContact::Held) {
      system.row(axis) = mobility.row(axis);
      right[axis] = -velocity[axis];
      any_held = true;
    } else {
      right[axis] = contact == AxisContact::AtLow ? box.low[axis] : box.high[axis];
    }
  }
  if (!any_held) return right;
  return system.partialPivLu().solve(right);
}

/// How far `impulses` contradict the assumption that led to them, as the largest impulse (N s) by which an axis is off.
double contradiction(const mechanism::Matrix4& mobility, const mechanism::Vector4& velocity, const ImpulseBox& box,
                     const AxisContacts& contacts, const mechanism::Vector4& impulses) {
  if (!impulses.allFinite()) return kImpossible;
  const mechanism::Vector4 result = velocity + mobility * impulses;
  double worst = 0.0;
  for (int axis = 0; axis < mechanism::kLegs; ++axis) {
    if (isFree(box, axis)) continue;
    const double per_impulse = mobility(axis, axis);
    double off = 0.0;
    switch (contacts[static_cast<std::size_t>(axis)]) {
      case AxisContact::Held:
        off = std::max(impulses[axis] - box.high[axis], box.low[axis] - impulses[axis]);
        break;
      case AxisContact::AtLow:
        off = -result[axis] / per_impulse;
        break;
      case AxisContact::AtHigh:
        off = result[axis] / per_impulse;
        break;
    }
    worst = std::max(worst, off - kRounding * std::abs(velocity[axis] / per_impulse));
  }
  return worst;
}

/// Next combination in counting order; false after the last.
bool advance(AxisContacts& contacts) {
  for (AxisContact& contact : contacts) {
    switch (contact) {
      case AxisContact::Held:
        contact = AxisContact::AtLow;
        return true;
      case AxisContact::AtLow:
        contact = AxisContact::AtHigh;
        return true;
      case AxisContact::AtHigh:
        contact = AxisContact::Held;
        break;
    }
  }
  return false;
}

/// An axis without friction has one way only; a bound that is infinite cannot be reached.
bool possible(const ImpulseBox& box, const AxisContacts& contacts) {
  for (int axis = 0; axis < mechanism::kLegs; ++axis) {
    const AxisContact contact = contacts[static_cast<std::size_t>(axis)];
    if (isFree(box, axis) && contact != AxisContact::AtLow) return false;
    if (contact == AxisContact::AtLow && std::isinf(box.low[axis])) return false;
    if (contact == AxisContact::AtHigh && std::isinf(box.high[axis])) return false;
  }
  return true;
}

}  // namespace

mechanism::Vector4 solveBoxFriction(const mechanism::Matrix4& mobility, const mechanism::Vector4& velocity,
                                    const ImpulseBox& box, AxisContacts& contacts) {
  AxisContacts trial = contacts;
  AxisContacts best = contacts;
  mechanism::Vector4 best_impulses = mechanism::Vector4::Zero();
  double best_contradiction = kImpossible;
  const auto consider = [&] {
    if (!possible(box, trial)) return;
    const mechanism::Vector4 impulses = impulsesFor(mobility, velocity, box, trial);
    const double found = contradiction(mobility, velocity, box, trial, impulses);
    if (found < best_contradiction) {
      best_contradiction = found;
      best = trial;
      best_impulses = impulses;
    }
  };
  consider();
  trial.fill(AxisContact::Held);
  while (best_contradiction > 0.0) {
    consider();
    if (!advance(trial)) break;
  }
  contacts = best;
  // Inside the bounds to the last digit: what rounding left outside would be friction that drives.
  return best_impulses.cwiseMax(box.low).cwiseMin(box.high);
}

}  // namespace knee_robot::simulation
