#include "long_presliding.h"

#include <algorithm>
#include <cstddef>

namespace knee_robot::tracing {
namespace {

constexpr double kLong_m = 5e-5;  ///< two and a half steps of a 20 um encoder
constexpr double kMost = 0.5;     ///< share of the friction that builds up over a long way
constexpr double kSurely = 2.0;   ///< standard errors by which laws without must be worse

bool mostlyLong(const dynamics::FrictionLaw& law) {
  double share = 0.0;
  for (int k = 0; k < law.count; ++k) {
    const dynamics::FrictionElement& e = law.elements[static_cast<std::size_t>(k)];
    if (e.kind != dynamics::FrictionKind::Smooth && e.width_m >= kLong_m) share += e.share;
  }
  return share >= kMost;
}

bool surelyLong(const identification::FrictionChoice& choice) {
  return mostlyLong(choice.law) &&
         std::all_of(choice.tried.begin(), choice.tried.end(), [](const identification::TriedLaw& t) {
           return mostlyLong(t.law) || t.beyond_best > kSurely * t.standard_error;
         });
}

}  // namespace

std::string longPresliding(const std::vector<identification::FrictionChoice>& choices) {
  std::string where;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (choices[i].tried.empty() || !surelyLong(choices[i])) continue;
    where += std::string(where.empty() ? "" : ", ") + "of actuator " + std::to_string(i + 1) + " (" +
             dynamics::describe(choices[i].law) + ")";
  }
  if (where.empty()) return where;
  return "after a reversal dry friction builds up over a way far longer than an encoder's steps, " + where;
}

}  // namespace knee_robot::tracing
