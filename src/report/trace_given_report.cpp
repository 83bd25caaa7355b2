#include "trace_given_report.h"

#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/report/json_parts.h"

namespace knee_robot::report {
namespace {

constexpr double kDiffers = 2.0;  ///< standard errors of the new value

std::string placeText(const dynamics::ModelEffect& e) {
  return e.name + (e.depends_on.empty() ? "" : " (" + e.depends_on + ")") +
         (e.actuators.size() == 1 ? " on actuator " + std::to_string(e.actuators.front()) : " on all actuators");
}

std::string effectSentence(const tracing::GivenEffect& g) {
  std::string out = placeText(g.effect) + ": " + g.verdict;
  if (g.now.empty()) return out;
  out += "; held-back gain " + shortNumber(100.0 * g.gain, 2) + " +- " + shortNumber(100.0 * g.gain_error, 2) + " %";
  for (std::size_t k = 0; k < g.now.size() && g.effect.depends_on.empty(); ++k) {
    out += "; " + g.now[k].name + " ";
    if (g.now.size() == g.effect.coefficients.size()) out += shortNumber(g.effect.coefficients[k].value, 3) + " -> ";
    out += shortNumber(g.now[k].value, 3);
    if (std::isfinite(g.now[k].std)) out += " +- " + shortNumber(g.now[k].std, 2);
  }
  return out;
}

bool differs(const tracing::GivenParameter& p) {
  return std::abs(p.now - p.given) > kDiffers * p.std;
}

std::string parameterSentence(const tracing::GivenParameter& p) {
  return p.name + " " + shortNumber(p.given, 3) + " -> " + shortNumber(p.now, 3) + " +- " + shortNumber(p.std, 2) +
         " " + p.unit + (differs(p) ? " (differs)" : "");
}

}  // namespace

nlohmann::ordered_json givenModelJson(const tracing::GivenModel& given) {
  if (given.path.empty()) return {};
  Json j = {{"file", given.path}, {"effects", Json::array()}, {"parameters", Json::array()}};
  for (const tracing::GivenEffect& g : given.effects) {
    Json e = {{"name", g.effect.name},   {"actuators", g.effect.actuators},
              {"verdict", g.verdict},    {"sentence", effectSentence(g)},
              {"kept", g.kept},          {"held_back_gain", {{"share", g.gain}, {"standard_error", g.gain_error}}},
              {"given", Json::object()}, {"now", Json::object()}};
    for (const dynamics::EffectParameter& p : g.effect.coefficients)
      e["given"][p.name] = {{"value", p.value}, {"std", jsonNumber(p.std)}};
    for (const dynamics::EffectParameter& p : g.now)
      e["now"][p.name] = {{"value", p.value}, {"std", jsonNumber(p.std)}};
    j["effects"].push_back(e);
  }
  for (const tracing::GivenParameter& p : given.parameters) {
    j["parameters"].push_back({{"name", p.name},
                               {"unit", p.unit},
                               {"given", p.given},
                               {"now", p.now},
                               {"std", jsonNumber(p.std)},
                               {"differs", differs(p)},
                               {"sentence", parameterSentence(p)}});
  }
  return j;
}

std::string givenModelSummary(const tracing::GivenModel& given) {
  if (given.path.empty()) return {};
  std::string out = "started from " + given.path + "; on these recordings\n";
  for (const tracing::GivenEffect& g : given.effects)
    out += "  " + effectSentence(g) + "\n";
  for (const tracing::GivenParameter& p : given.parameters)
    out += "  " + parameterSentence(p) + "\n";
  return out;
}

}  // namespace knee_robot::report
