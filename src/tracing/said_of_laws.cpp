#include "said_of_laws.h"

#include <algorithm>
#include <cstddef>

#include "knee_robot/base/numbers.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLong_m = 5e-5;      ///< two and a half steps of a 20 um encoder
constexpr double kMost = 0.5;         ///< share of the friction that builds up over a long way
constexpr double kSurelyWorse = 2.0;  ///< standard errors by which laws without must be worse

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
           return mostlyLong(t.law) || t.beyond_best > kSurelyWorse * t.standard_error;
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

std::string peakNearRest(const std::vector<identification::FrictionChoice>& choices) {
  std::string where;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const double peak = dynamics::peakOf(choices[i].law);
    if (choices[i].tried.empty() || peak == 0.0) continue;
    where += std::string(where.empty() ? "" : ", ") + "by up to " + shortNumber(100.0 * peak, 2) + " % on actuator " +
             std::to_string(i + 1) + " (" + dynamics::describe(choices[i].law) + ")";
  }
  return where.empty() ? where : "dry friction is larger near rest than beyond, " + where;
}

}  // namespace knee_robot::tracing
