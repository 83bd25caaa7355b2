#include "knee_robot/dynamics/friction_law.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "knee_robot/base/numbers.h"
#include "knee_robot/mechanism/chain.h"

namespace knee_robot::dynamics {
namespace {

bool all(const FrictionLaw& law, FrictionKind kind) {
  return std::all_of(law.elements.begin(), law.elements.begin() + law.count,
                     [kind](const FrictionElement& e) { return e.kind == kind; });
}

/// How a smooth law is called and written, in the order of SmoothShape; the speed stands between `before` and `after`.
constexpr struct {
  const char *name, *words, *before, *after;
} kSmooth[] = {{"tanh", "tanh of velocity", "tanh(v / ", ")"},
               {"ramp", "ramp of velocity", "ramp up to ", ""},
               {"rational", "rational law of velocity", "v / (|v| + ", ")"},
               {"root", "root law of velocity", "v / sqrt(v^2 + (", ")^2)"},
               {"arctangent", "arctangent of velocity", "2/pi atan(v / ", ")"}};

constexpr const auto& textsOf(SmoothShape shape) {
  return kSmooth[static_cast<std::size_t>(shape)];
}

std::string elementText(const FrictionElement& e, bool revolute) {
  const double radius = revolute ? mechanism::kJointRadius_m : 1.0;
  const std::string width = shortNumber(1e6 * e.width_m / radius, 3) + (revolute ? " urad" : " um");
  const std::string speed = shortNumber(1e3 * e.speed_m_per_s / radius, 3) + (revolute ? " mrad/s" : " mm/s");
  switch (e.kind) {
    case FrictionKind::Stop:
      return "stop " + width +
             (e.gap_m > 0.0 ? ", gap " + shortNumber(1e6 * e.gap_m / radius, 3) + (revolute ? " urad" : " um") : "") +
             (e.relaxation_s > 0.0 ? ", relaxes in " + shortNumber(e.relaxation_s, 2) + " s" : "");
    case FrictionKind::Smooth:
      return (e.exponent == 1.0 ? textsOf(e.smooth).before + speed + textsOf(e.smooth).after
                                : "tanh((v / " + speed + ")^" + shortNumber(e.exponent, 3) + ")") +
             (e.lag_s > 0.0 ? ", lags by " + shortNumber(1e3 * e.lag_s, 2) + " ms" : "");
    default:
      break;
  }
  std::string text = "bristles " + width;
  if (e.exponent != 1.0) text += ", exponent " + shortNumber(e.exponent, 3);
  if (e.speed_m_per_s > 0.0) text += ", creep " + speed;
  if (e.tremble > 0.0) text += ", " + shortNumber(e.tremble, 3) + " of the tremble";
  if (e.damping_s > 0.0) text += ", damping " + shortNumber(1e3 * e.damping_s, 3) + " ms";
  return text;
}

/// Of a velocity in units of the law's speed, with its sign: its shape, or tanh of its power.
double smooth(double velocity, const FrictionElement& e) noexcept {
  switch (e.smooth) {
    case SmoothShape::Ramp:
      return std::clamp(velocity, -1.0, 1.0);
    case SmoothShape::Rational:
      return velocity / (1.0 + std::abs(velocity));
    case SmoothShape::Root:
      return velocity / std::sqrt(1.0 + velocity * velocity);
    case SmoothShape::Arctangent:
      return M_2_PI * std::atan(velocity);
    default:
      break;
  }
  if (e.exponent == 1.0) return std::tanh(velocity);
  return std::copysign(std::tanh(std::pow(std::abs(velocity), e.exponent)), velocity);
}

/// What is missing to full friction, u = 1 - z sign(dx), after |dx| = way: du = -u^exponent |dx| / width, exactly.
double missing(double before, double way, double exponent) noexcept {
  if (exponent == 1.0) return before * std::exp(-way);
  if (!(before > 0.0)) return 0.0;
  if (exponent == 2.0) return before / (1.0 + before * way);
  const double left = std::pow(before, 1.0 - exponent) + (exponent - 1.0) * way;
  return left > 0.0 ? std::pow(left, 1.0 / (1.0 - exponent)) : 0.0;
}

/// Moves a stop: `z` is how far it is bent, of the way from its middle to where it slips.
double stop(const FrictionElement& e, double displacement_m, double duration_s, double& z) noexcept {
  if (e.relaxation_s > 0.0) z *= std::exp(-duration_s / e.relaxation_s);
  const double half_gap_m = 0.5 * e.gap_m, whole_m = e.width_m + half_gap_m;
  z = std::clamp(z + displacement_m / whole_m, -1.0, 1.0);
  return e.gap_m > 0.0 ? std::copysign(std::max(0.0, std::abs(z) * whole_m - half_gap_m) / e.width_m, z) : z;
}

/// A smooth law: `z` is the velocity that it has followed to, in units of its speed.
double lagging(const FrictionElement& e, double displacement_m, double duration_s, double& z) noexcept {
  const double now = displacement_m / (duration_s * e.speed_m_per_s);
  z = e.lag_s > 0.0 ? now + (z - now) * std::exp(-duration_s / e.lag_s) : now;
  return smooth(z, e);
}

}  // namespace

bool FrictionLaw::operator==(const FrictionLaw& o) const {
  return count == o.count && at_start == o.at_start &&
         std::equal(elements.begin(), elements.begin() + count, o.elements.begin());
}

FrictionLaw stopLaw(double width_m) {
  return lawOf({{FrictionKind::Stop, 1.0, width_m, 0.0, 0.0}});
}

FrictionLaw smoothLaw(double speed_m_per_s, SmoothShape shape) {
  FrictionElement e{FrictionKind::Smooth, 1.0, 0.0, speed_m_per_s};
  e.smooth = shape;
  return lawOf({e});
}

FrictionLaw bristleLaw(double width_m, double creep_m_per_s, double damping_s, double tremble) {
  return lawOf({{FrictionKind::Bristles, 1.0, width_m, creep_m_per_s, damping_s, tremble}});
}

FrictionLaw lawOf(const std::vector<FrictionElement>& elements) {
  double sum = 0.0;
  for (const FrictionElement& e : elements)
    sum += e.share;
  if (elements.empty() || elements.size() > static_cast<std::size_t>(kMostFrictionElements) || !(sum > 0.0))
    throw std::invalid_argument("a law of friction has 1 to 8 elements with positive shares");
  FrictionLaw law;
  law.count = static_cast<int>(elements.size());
  for (std::size_t k = 0; k < elements.size(); ++k) {
    law.elements[k] = elements[k];
    law.elements[k].share /= sum;
  }
  return law;
}

double peakOf(const FrictionLaw& law) {
  double peak = 0.0;
  for (int k = 0; k < law.count; ++k)
    peak += std::max(0.0, -law.elements[static_cast<std::size_t>(k)].share);
  return peak;
}

std::string nameOf(const FrictionLaw& law) {
  const FrictionElement& first = law.elements.front();
  if (all(law, FrictionKind::Stop))
    return law.count == 1 ? "one stop" : law.count == 2 ? "two stops" : "spectrum of stops";
  if (peakOf(law) > 0.0) return "peak near rest";
  if (law.count > 1) return all(law, FrictionKind::Smooth) ? "sum of tanh of velocity" : "mixture";
  if (first.kind == FrictionKind::Smooth)
    return first.lag_s > 0.0 ? "tanh of lagging velocity" : textsOf(first.smooth).words;
  return first.speed_m_per_s > 0.0 || first.tremble > 0.0 ? "creeping bristles" : "bristles (Dahl)";
}

const char* smoothName(SmoothShape shape) {
  return textsOf(shape).name;
}

std::string describe(const FrictionLaw& law) {
  std::string text;
  for (int k = 0; k < law.count; ++k) {
    const FrictionElement& e = law.elements[static_cast<std::size_t>(k)];
    text += (k > 0 ? " + " : "") + elementText(e, law.revolute);
    if (law.count > 1) text += " (" + shortNumber(100.0 * e.share, 3) + " %)";
  }
  if (law.at_start == 0.0) return text;
  return text + ", bent by " + shortNumber(100.0 * law.at_start, 2) + " % of it when a recording begins";
}

double FrictionState::step(const FrictionLaw& law, double displacement_m, double duration_s,
                           double tremble_m_per_s) noexcept {
  double sum = 0.0;
  for (int k = 0; k < law.count; ++k) {
    const FrictionElement& e = law.elements[static_cast<std::size_t>(k)];
    double& z = z_[static_cast<std::size_t>(k)];
    if (e.kind == FrictionKind::Stop) {
      sum += e.share * stop(e, displacement_m, duration_s, z);
    } else if (e.kind == FrictionKind::Smooth) {
      sum += e.share * lagging(e, displacement_m, duration_s, z);
    } else {
      const double before = z;
      const double way =
          std::hypot(displacement_m, e.speed_m_per_s * duration_s) + e.tremble * tremble_m_per_s * duration_s;
      if (e.exponent != 1.0) {
        const double direction = displacement_m < 0.0 ? -1.0 : 1.0;
        z = direction * (1.0 - missing(1.0 - direction * z, std::abs(displacement_m) / e.width_m, e.exponent));
      } else if (way > 0.0) {  // exact for a constant velocity within the step
        const double settled = displacement_m / way;
        z = settled + (z - settled) * std::exp(-way / e.width_m);
      }
      sum += e.share * (z + e.damping_s * (z - before) / duration_s);
    }
  }
  return sum;
}

}  // namespace knee_robot::dynamics
