#include "friction_html.h"

#include <cmath>

#include "html_parts.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/svg_plot.h"

namespace knee_robot::report {
namespace {

constexpr double kStep_s = 1e-3, kReversal_s = 1.0;
constexpr double kAcceleration_m_per_s2 = 5e-3;

/// The share along a motion that slows down, reverses at 1 s, and speeds up again by 5 mm/s2, over the distance from the turn.
PlotLine aroundReversal(const dynamics::FrictionLaw& law, const std::string& label, const char* color) {
  PlotLine line{label, color, {}, {}};
  dynamics::FrictionState state;
  state.start(1.0);
  double before = -0.5 * kAcceleration_m_per_s2 * kReversal_s * kReversal_s;
  for (double t = kStep_s; t <= 2.0 * kReversal_s; t += kStep_s) {
    const double to_turn = t - kReversal_s;
    const double position = -0.5 * kAcceleration_m_per_s2 * to_turn * to_turn;
    line.x.push_back(1e3 * to_turn);
    line.y.push_back(state.step(law, position - before, kStep_s));
    before = position;
  }
  return line;
}

std::string triedTable(const std::vector<identification::FrictionChoice>& choices) {
  std::string out =
      "<table><tr><th>actuator</th><th class=\"text\">best law of each family</th><th>held-back error / noise</th>"
      "<th>beyond the best</th><th>standard error</th></tr>\n";
  for (std::size_t i = 0; i < choices.size(); ++i) {
    for (const identification::TriedLaw& t : choices[i].tried) {
      const bool chosen = t.law == choices[i].law;
      out += "<tr><td>" + std::to_string(i + 1) + (chosen ? " (chosen)" : "") + "</td><td class=\"text\">" +
             escapeHtml(dynamics::describe(t.law)) + "</td><td>" + shortNumber(std::sqrt(t.held_back), 4) +
             "</td><td>" + shortNumber(t.beyond_best, 3) + "</td><td>" + shortNumber(t.standard_error, 3) +
             "</td></tr>\n";
    }
  }
  return out + "</table>\n";
}

}  // namespace

std::string frictionHtml(const std::vector<dynamics::FrictionLaw>& laws,
                         const std::vector<identification::FrictionChoice>& choices) {
  static const char* const kColors[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd"};
  std::string out = "<h2>Friction near rest</h2>\n<table><tr><th>actuator</th><th class=\"text\">law</th></tr>\n";
  std::vector<PlotLine> lines;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const std::string name = std::to_string(i + 1);
    out += "<tr><td>" + name + "</td><td class=\"text\">" + dynamics::nameOf(laws[i]) + ": " +
           escapeHtml(dynamics::describe(laws[i])) + "</td></tr>\n";
    lines.push_back(aroundReversal(laws[i], "actuator " + name, kColors[i % 4]));
  }
  PlotStyle style;
  style.x_label = "ms from the reversal, at 5 mm/s2";
  style.y_label = "share of Coulomb friction";
  out += "</table>\n" + svgPlot(lines, style);
  if (choices.empty()) return out;
  return out +
         "<p>Chosen on training data alone: blocks are left out in turn, shapes and shares are found without them; the "
         "simplest family within a quarter of a standard error of the best is taken.</p>\n" +
         triedTable(choices);
}

}  // namespace knee_robot::report
