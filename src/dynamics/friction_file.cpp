#include "friction_file.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/mechanism/chain.h"

namespace knee_robot::dynamics {
namespace {

constexpr double kNarrowest_m = 1e-12, kWidest_m = 1e3;
constexpr double kMostPeak = 1.0;  ///< of sliding friction: what others may build up beyond it near rest
constexpr double kSlowest_m_per_s = 1e-9, kFastest_m_per_s = 1e3;

double radiusOf(bool revolute) {
  return revolute ? mechanism::kJointRadius_m : 1.0;
}

std::string elementYaml(const FrictionElement& e, bool revolute) {
  const double radius = radiusOf(revolute);
  const std::string unit = revolute ? "rad" : "m";
  const std::string share = ", share: " + exactNumber(e.share) + "}";
  const std::string width = ", width_" + unit + ": " + exactNumber(e.width_m / radius);
  const std::string speed = ", speed_" + unit + "_per_s: " + exactNumber(e.speed_m_per_s / radius);
  const std::string exponent = e.exponent != 1.0 ? ", exponent: " + exactNumber(e.exponent) : "";
  switch (e.kind) {
    case FrictionKind::Stop:
      return "{law: stop" + width + (e.gap_m > 0.0 ? ", gap_" + unit + ": " + exactNumber(e.gap_m / radius) : "") +
             (e.relaxation_s > 0.0 ? ", relaxation_s: " + exactNumber(e.relaxation_s) : "") + share;
    case FrictionKind::Smooth:
      return std::string("{law: ") + smoothName(e.smooth) + speed + exponent +
             (e.lag_s > 0.0 ? ", lag_s: " + exactNumber(e.lag_s) : "") + share;
    default:
      return "{law: bristles" + width + speed + ", damping_s: " + exactNumber(e.damping_s) +
             (e.tremble > 0.0 ? ", tremble: " + exactNumber(e.tremble) : "") + exponent + share;
  }
}

FrictionElement readElement(StrictMap map, bool revolute) {
  const double radius = radiusOf(revolute);
  const auto width = [&] {
    return radius * (revolute ? map.number("width_rad", kNarrowest_m, kWidest_m)
                              : map.number("width_m", kNarrowest_m, kWidest_m));
  };
  const auto gap = [&] {
    return radius *
           (revolute ? map.number("gap_rad", kNarrowest_m, kWidest_m) : map.number("gap_m", kNarrowest_m, kWidest_m));
  };
  const auto speed = [&](double slowest) {
    return radius * (revolute ? map.number("speed_rad_per_s", slowest, kFastest_m_per_s)
                              : map.number("speed_m_per_s", slowest, kFastest_m_per_s));
  };
  FrictionElement e;
  const std::string law = map.choice("law", {"stop", "tanh", "ramp", "rational", "root", "arctangent", "bristles"});
  e.kind = law == "stop" ? FrictionKind::Stop : law == "bristles" ? FrictionKind::Bristles : FrictionKind::Smooth;
  for (const SmoothShape shape : {SmoothShape::Ramp, SmoothShape::Rational, SmoothShape::Root, SmoothShape::Arctangent})
    if (law == smoothName(shape)) e.smooth = shape;
  e.share = map.number("share", e.kind == FrictionKind::Stop ? 1e-9 : -kMostPeak, 1.0 + kMostPeak);
  if (std::abs(e.share) < 1e-9) map.refuse("share", "is 0: leave the element out");
  e.width_m = e.kind == FrictionKind::Smooth ? 0.0 : width();
  if (e.kind == FrictionKind::Stop && map.has(revolute ? "gap_rad" : "gap_m")) e.gap_m = gap();
  if (e.kind == FrictionKind::Stop && map.has("relaxation_s")) e.relaxation_s = map.number("relaxation_s", 1e-3, 1e6);
  if (e.kind == FrictionKind::Smooth) e.speed_m_per_s = speed(kSlowest_m_per_s);
  if (law == "tanh" && map.has("lag_s")) e.lag_s = map.number("lag_s", 1e-6, 1e3);
  if ((law == "bristles" || law == "tanh") && map.has("exponent")) e.exponent = map.number("exponent", 0.1, 10.0);
  if (e.kind == FrictionKind::Bristles) {
    e.speed_m_per_s = speed(0.0);
    e.damping_s = map.number("damping_s", 0.0, 1.0);
    if (map.has("tremble")) e.tremble = map.number("tremble", 0.0, 10.0);
    if (e.exponent != 1.0 && (e.speed_m_per_s > 0.0 || e.tremble > 0.0))
      map.refuse("exponent", "is for bristles that neither creep nor tremble: leave it out or make the speed 0");
  }
  map.finish();
  return e;
}

}  // namespace

std::string frictionText(const std::vector<FrictionLaw>& laws, const std::string& key) {
  std::string y =
      "# Law of friction near rest: elements whose shares of the actuator's Coulomb friction (Fc) add up to 1.\n" +
      key + ":\n";
  for (std::size_t i = 0; i < laws.size(); ++i) {
    y += "  - {actuator: " + std::to_string(i + 1) + ", elements: [";
    for (int k = 0; k < laws[i].count; ++k)
      y += (k > 0 ? ", " : "") + elementYaml(laws[i].elements[static_cast<std::size_t>(k)], laws[i].revolute);
    y += "]";
    if (laws[i].at_start != 0.0) y += ", at_start: " + exactNumber(laws[i].at_start);
    y += "}\n";
  }
  return y;
}

std::vector<FrictionLaw> readFriction(StrictMap& file, const std::string& key, int axes,
                                      const std::vector<char>& revolute) {
  std::vector<StrictMap> entries = file.maps(key);
  if (entries.size() != static_cast<std::size_t>(axes))
    file.refuse(key, "has " + std::to_string(entries.size()) + " entries where " + std::to_string(axes) +
                         " actuators need one each");
  std::vector<FrictionLaw> laws;
  for (StrictMap& entry : entries) {
    const int actuator = static_cast<int>(laws.size()) + 1;
    if (entry.integer("actuator", 1, axes) != actuator)
      entry.refuse("actuator", "belongs to entry " + std::to_string(actuator) + "; list the actuators in order");
    std::vector<FrictionElement> elements;
    double sum = 0.0;
    const bool turns = !revolute.empty() && revolute[laws.size()];
    for (StrictMap& element : entry.maps("elements")) {
      elements.push_back(readElement(element, turns));
      sum += elements.back().share;
    }
    if (elements.empty() || elements.size() > static_cast<std::size_t>(kMostFrictionElements) ||
        std::abs(sum - 1.0) > 1e-6) {
      entry.refuse("elements", "must be 1 to " + std::to_string(kMostFrictionElements) +
                                   " elements whose shares add up to 1 (they add up to " + shortNumber(sum) + ")");
    }
    const double at_start = entry.numberOr("at_start", 0.0, -1.0, 1.0);
    entry.finish();
    FrictionLaw law;  // as written: lawOf would bring the shares to their sum again, and lose a bit
    law.count = static_cast<int>(elements.size());
    law.revolute = turns;
    law.at_start = at_start;
    std::copy(elements.begin(), elements.end(), law.elements.begin());
    if (peakOf(law) > kMostPeak)
      entry.refuse("elements", "take away " + shortNumber(peakOf(law), 3) +
                                   " of the sliding friction (shares below 0): friction near rest may be larger by up "
                                   "to " +
                                   shortNumber(kMostPeak) + " of it");
    laws.push_back(law);
  }
  return laws;
}

}  // namespace knee_robot::dynamics
