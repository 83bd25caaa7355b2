#include "knee_robot/report/tuning_report.h"

#include <cmath>
#include <cstdio>

#include "html_parts.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/svg_plot.h"

namespace knee_robot::report {
namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr double kPlotted_s = 0.5;

std::string gainsText(const control::PidGains& g) {
  return "P " + exactNumber(g.proportional) + " N/m, I " + exactNumber(g.integral) + " N/(m s), D " +
         exactNumber(g.derivative) + " N s/m, low-pass " + exactNumber(g.derivative_cutoff_hz) + " Hz";
}

std::string factor(double value) {
  return std::isfinite(value) ? shortNumber(value, 3) : "any";
}

std::string marginsText(const control::LoopMargins& m) {
  if (!m.stable) return "UNSTABLE somewhere in that range";
  return "gain x" + factor(m.gain_up) + " and x" + shortNumber(m.gain_down, 2) + ", phase " +
         shortNumber(kDegrees * m.phase_rad, 3) + " deg, delay " + shortNumber(1e3 * m.delay_s, 2) +
         " ms, peak of the sensitivity " + shortNumber(m.sensitivity, 3) + ", crossover up to " +
         shortNumber(m.crossover_hz, 3) + " Hz";
}

std::string between(double low, double high, int digits = 3) {
  return shortNumber(low, digits) + " .. " + shortNumber(high, digits);
}

std::string plantText(const TunedAxis& a) {
  return between(a.range.low.mass_kg, a.range.high.mass_kg) + " kg (" + a.range_source + "), viscous friction " +
         between(a.range.low.viscous_N_s_per_m, a.range.high.viscous_N_s_per_m, 2) + " N s/m, delay " +
         between(1e3 * a.range.low.delay_s, 1e3 * a.range.high.delay_s, 2) + " ms; shown up to " +
         shortNumber(a.highest_crossover_hz, 3) + " Hz";
}

std::string verdict(const TuningResults& r, const TunedAxis& a) {
  const bool kept = r.demand.isMetBy(a.present_worst);
  if (!a.proposed) return "no gains of this shape keep the margin: make the delay or the range of masses smaller";
  const std::string room = kept ? "the present gains keep the margin" : "the present gains do NOT keep the margin";
  if (a.present.proportional > a.proposed->proportional && kept)
    return room + " and are stiffer; with them a count changes the force by " + shortNumber(a.present_kick_N, 2) + " N";
  return room;
}

std::string demandText(const TuningResults& r) {
  return "gains may grow by x" + shortNumber(r.demand.gain, 3) + " and fall by the same, phase at least " +
         shortNumber(kDegrees * r.demand.phase_rad, 3) + " deg, sensitivity at most " +
         shortNumber(r.demand.sensitivity, 3) + ", crossover no higher than what the recording shows";
}

PlotLine sensitivityLine(const std::string& label, const char* color, const control::PidGains& gains,
                         const control::AxisPlant& plant, double period) {
  PlotLine line{label, color, {}, {}};
  for (const double f : control::marginFrequencies(period)) {
    const auto loop = control::pidResponse(gains, period, f) * control::plantResponse(plant, period, f);
    line.x.push_back(std::log10(f));
    line.y.push_back(1.0 / std::abs(1.0 + loop));
  }
  return line;
}

PlotLine stepLine(const std::string& label, const char* color, const control::PidGains& gains,
                  const control::AxisPlant& plant, double period) {
  PlotLine line{label, color, {}, control::stepResponse(gains, plant, period, static_cast<int>(kPlotted_s / period))};
  for (std::size_t k = 0; k < line.y.size(); ++k)
    line.x.push_back(static_cast<double>(k) * period);
  return line;
}

PlotStyle style(const std::string& x, const std::string& y) {
  PlotStyle style;
  style.x_label = x;
  style.y_label = y;
  return style;
}

std::string plots(const TuningResults& r, std::size_t i) {
  const TunedAxis& a = r.axes[i];
  const auto column = static_cast<int>(i);
  const PlotStyle force = style("time (s)", "force (N)"), step = style("time (s)", "position after a step of 1"),
                  sensitivity = style("log10 of frequency (Hz)", "|1 / (1 + L)|");
  std::string html =
      svgPlot({{"commanded", kMeasuredColor, r.responses.time_s, series(r.responses.force_N, column)},
               {"inertia, friction, delay", kModelColor, r.responses.time_s, series(r.responses.model_N, column)}},
              force);
  std::vector<PlotLine> peaks, steps;
  // The worst of either end: hardly any friction, the longest delay.
  control::AxisPlant lightest = a.range.low, heaviest = a.range.high;
  lightest.delay_s = heaviest.delay_s;
  heaviest.viscous_N_s_per_m = lightest.viscous_N_s_per_m;
  const auto add = [&](const std::string& name, const control::PidGains& gains, const char* light, const char* heavy) {
    peaks.push_back(sensitivityLine(name + ", light", light, gains, lightest, r.servo_period_s));
    peaks.push_back(sensitivityLine(name + ", heavy", heavy, gains, heaviest, r.servo_period_s));
    steps.push_back(stepLine(name + ", light", light, gains, lightest, r.servo_period_s));
    steps.push_back(stepLine(name + ", heavy", heavy, gains, heaviest, r.servo_period_s));
  };
  if (a.present_worst.stable) add("present", a.present, "#bbbbbb", "#777777");
  if (a.proposed) add("proposed", *a.proposed, kMeasuredColor, kModelColor);
  if (peaks.empty()) return html;
  return html + svgPlot(peaks, sensitivity) + svgPlot(steps, step);
}

std::string gainsFile(const TuningResults& r) {
  std::string text = "# Properties for the Drivers of the deployment file; made from " + r.recording + ".\n";
  for (const TunedAxis& a : r.axes) {
    if (!a.proposed) continue;
    text += a.driver + ": {proportional_N_per_m: " + exactNumber(a.proposed->proportional) +
            ", integral_N_per_m_s: " + exactNumber(a.proposed->integral) +
            ", derivative_N_s_per_m: " + exactNumber(a.proposed->derivative) +
            ", derivative_cutoff_hz: " + exactNumber(a.proposed->derivative_cutoff_hz) + "}\n";
  }
  return text;
}

/// Title and words of one actuator, line by line.
std::vector<std::pair<std::string, std::string>> wordsOf(const TuningResults& r, std::size_t i) {
  const TunedAxis& a = r.axes[i];
  if (!a.reason.empty()) return {{"not judged", a.reason}};
  const identification::AxisResponse& x = r.responses.axes[i];
  std::vector<std::pair<std::string, std::string>> words = {
      {"measured", shortNumber(x.mass_kg, 3) + " +- " + shortNumber(x.mass_std, 2) + " kg, delay " +
                       shortNumber(1e3 * x.delay_s, 3) + " +- " + shortNumber(1e3 * x.delay_std, 2) +
                       " ms, Coulomb friction " + shortNumber(x.coulomb_N, 3) + " N; explains " +
                       shortNumber(100.0 * x.explained, 3) + " % of the force"},
      {"range", plantText(a)},
      {"present", gainsText(a.present)},
      {"its margin", marginsText(a.present_worst)}};
  if (a.proposed) {
    words.emplace_back("proposed", gainsText(*a.proposed));
    words.emplace_back("its margin", marginsText(a.proposed_worst) + "; one encoder count changes the force by " +
                                         shortNumber(a.proposed_kick_N, 2) + " N");
  }
  words.emplace_back("so", verdict(r, a));
  return words;
}

}  // namespace

std::string tuningSummary(const TuningResults& r) {
  std::string text = "demanded over each range: " + demandText(r) + "\n";
  for (std::size_t i = 0; i < r.axes.size(); ++i) {
    text += r.axes[i].name + " (" + r.axes[i].driver + ")\n";
    for (const auto& [title, words] : wordsOf(r, i)) {
      char head[20];
      std::snprintf(head, sizeof head, "  %-11s ", title.c_str());
      text += head + words + "\n";
    }
  }
  return text;
}

void writeTuning(const TuningResults& r, const std::string& command_line, const std::string& folder) {
  std::string html = pageHead("Gains from " + r.recording);
  html += "<p>Demanded over the whole range of inertia, friction and delay: " + escapeHtml(demandText(r)) +
          ". A margin is the worst over that range. Coulomb friction, which only damps, is left out. What the "
          "recording does not "
          "show (a flexible coupling, an amplifier that saturates) no margin knows: try new gains without anybody on "
          "the robot, "
          "and at low speed first.</p>\n";
  for (std::size_t i = 0; i < r.axes.size(); ++i) {
    html += "<h2>" + escapeHtml(r.axes[i].name) + " (" + escapeHtml(r.axes[i].driver) + ")</h2>\n<table>\n";
    for (const auto& [title, words] : wordsOf(r, i))
      html +=
          "<tr><th>" + escapeHtml(title) + "</th><td style=\"text-align:left\">" + escapeHtml(words) + "</td></tr>\n";
    html += "</table>\n";
    if (r.axes[i].reason.empty()) html += plots(r, i);
  }
  html += pageEnd(command_line);
  makeFolder(folder);
  writeFileAtomically(folder + "/report.html", html);
  writeFileAtomically(folder + "/gains.yaml", gainsFile(r));
}

}  // namespace knee_robot::report
