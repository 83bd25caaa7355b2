#include "element_along.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::identification {
namespace {

using dynamics::FrictionElement;
using dynamics::FrictionKind;
using dynamics::SmoothShape;

/// tanh of all of these at once: exp has a vector form.
Eigen::ArrayXd tanhOf(const Eigen::ArrayXd& x) {
  return 1.0 - 2.0 / (1.0 + (2.0 * x).exp());
}

Eigen::ArrayXd smoothAlong(const FrictionElement& e, const Eigen::ArrayXd& moved_m, double step_s) {
  Eigen::ArrayXd velocity = moved_m / (step_s * e.speed_m_per_s);
  const double kept = e.lag_s > 0.0 ? std::exp(-step_s / e.lag_s) : 0.0;
  double z = 0.0;
  for (Eigen::Index k = 0; kept > 0.0 && k < velocity.size(); ++k)
    velocity[k] = z = velocity[k] + (z - velocity[k]) * kept;
  switch (e.smooth) {
    case SmoothShape::Ramp:
      return velocity.max(-1.0).min(1.0);
    case SmoothShape::Rational:
      return velocity / (1.0 + velocity.abs());
    case SmoothShape::Root:
      return velocity / (1.0 + velocity.square()).sqrt();
    case SmoothShape::Arctangent:
      return M_2_PI * velocity.atan();
    default:
      break;
  }
  if (e.exponent == 1.0) return tanhOf(velocity);
  return velocity.sign() * tanhOf(velocity.abs().pow(e.exponent));
}

/// What the path moves in a step around every substep: the move that ends there is that of half a step before, and
/// friction half a step late at every reversal reads as mass.
Eigen::ArrayXd centredMoves(const Eigen::ArrayXd& moved_m) {
  const Eigen::Index n = moved_m.size();
  Eigen::ArrayXd centred(n + 1);
  centred[0] = moved_m[0];
  centred[n] = moved_m[n - 1];
  centred.segment(1, n - 1) = 0.5 * (moved_m.head(n - 1) + moved_m.tail(n - 1));
  return centred;
}

Eigen::ArrayXd stopAlong(const FrictionElement& e, const Eigen::ArrayXd& moved_m, double step_s, double z) {
  const double kept = e.relaxation_s > 0.0 ? std::exp(-step_s / e.relaxation_s) : 1.0;
  const double half_gap_m = 0.5 * e.gap_m, whole_m = e.width_m + half_gap_m;
  Eigen::ArrayXd bent(moved_m.size());
  for (Eigen::Index k = 0; k < bent.size(); ++k)
    bent[k] = z = std::clamp(kept * z + moved_m[k] / whole_m, -1.0, 1.0);
  if (e.gap_m == 0.0) return bent;
  return bent.sign() * (bent.abs() * whole_m - half_gap_m).max(0.0) / e.width_m;
}

/// Dahl's law without an exponent: exact for a constant velocity within a substep.
Eigen::ArrayXd bristlesAlong(const FrictionElement& e, const Eigen::ArrayXd& moved_m, const Eigen::VectorXd& tremble,
                             double step_s, double z) {
  const double creep_m = e.speed_m_per_s * step_s;
  Eigen::ArrayXd way = creep_m > 0.0 ? (moved_m.square() + creep_m * creep_m).sqrt().eval() : moved_m.abs().eval();
  for (Eigen::Index k = 0; tremble.size() > 0 && e.tremble > 0.0 && k < way.size(); ++k)
    way[k] += e.tremble * tremble[(k + 1) / SlidingPath::kSubsteps] * step_s;
  Eigen::ArrayXd share = (-way / e.width_m).exp();  // of what is bent, that stays so
  const double damping = e.damping_s / step_s;
  for (Eigen::Index k = 0; k < share.size(); ++k) {
    const double before = z, settled = way[k] > 0.0 ? moved_m[k] / way[k] : z;
    z = settled + (z - settled) * share[k];
    share[k] = z + damping * (z - before);
  }
  return share;
}

/// Dahl's law with an exponent n: what is missing to full friction, u = 1 - z sign(dx), follows du = -u^n |dx| / width,
/// so that u^(1 - n) grows with the way. Powers are taken of all substeps at once, and one by one where the direction
/// changes.
Eigen::ArrayXd powerBristlesAlong(const FrictionElement& e, const Eigen::ArrayXd& moved_m, double step_s,
                                  double at_start) {
  const double power = 1.0 - e.exponent, root = 1.0 / power;
  Eigen::ArrayXd grown(moved_m.size()), direction(moved_m.size());
  double side = 1.0, now = std::pow(std::max(0.0, 1.0 - at_start), power);
  for (Eigen::Index k = 0; k < grown.size(); ++k) {
    if (moved_m[k] * side < 0.0) {
      side = -side;
      now = std::pow(2.0 - std::pow(now, root), power);
    }
    grown[k] = now = std::max(0.0, now - power * std::abs(moved_m[k]) / e.width_m);
    direction[k] = side;
  }
  const Eigen::ArrayXd bent = direction * (1.0 - grown.pow(root));
  if (e.damping_s == 0.0) return bent;
  Eigen::ArrayXd before(bent.size());
  before << at_start, bent.head(bent.size() - 1);
  return bent + e.damping_s / step_s * (bent - before);
}

const Eigen::VectorXd& pathOf(const SlidingPath& path, FrictionKind kind) {
  if (kind == FrictionKind::Stop) return path.position;
  return kind == FrictionKind::Smooth && path.taut.size() > 0 ? path.taut : path.measured;
}

}  // namespace

Eigen::VectorXd elementAlong(const SlidingPath& path, const FrictionElement& element, double at_start) {
  const Eigen::VectorXd& position = pathOf(path, element.kind);
  const Eigen::Index n = position.size();
  const bool remembers = element.kind != FrictionKind::Smooth;
  Eigen::VectorXd share = Eigen::VectorXd::Constant(n, remembers ? at_start : 0.0);
  if (n < 2) return share;
  const Eigen::ArrayXd moved_m = position.tail(n - 1) - position.head(n - 1);
  const double step_s = path.period_s / SlidingPath::kSubsteps;
  auto rest = share.tail(n - 1).array();
  if (element.kind == FrictionKind::Smooth) {
    share = smoothAlong(element, centredMoves(moved_m), step_s);
  } else if (element.kind == FrictionKind::Stop) {
    rest = stopAlong(element, moved_m, step_s, at_start);
  } else if (element.exponent == 1.0) {
    rest = bristlesAlong(element, moved_m, path.tremble, step_s, at_start);
  } else {
    rest = powerBristlesAlong(element, moved_m, step_s, at_start);
  }
  return share;
}

}  // namespace knee_robot::identification
