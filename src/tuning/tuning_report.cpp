#include "knee_robot/tuning/tuning_report.h"

#include <cmath>
#include <cstdio>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/json_parts.h"
#include "knee_robot/report/page.h"
#include "tuning_series.h"

namespace knee_robot::tuning {
namespace {

std::string gainsText(const control::PidGains& g) {
  return "P " + exactNumber(g.proportional) + " N/m, I " + exactNumber(g.integral) + " N/(m s), D " +
         exactNumber(g.derivative) + " N s/m, low-pass " + exactNumber(g.derivative_cutoff_hz) + " Hz";
}

std::string factor(double value) {
  return std::isfinite(value) ? shortNumber(value, 3) : "any";
}

std::string marginsText(const LoopMargins& m) {
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

report::Json gainsJson(const control::PidGains& g) {
  return {{"proportional_N_per_m", g.proportional},
          {"integral_N_per_m_s", g.integral},
          {"derivative_N_s_per_m", g.derivative},
          {"derivative_cutoff_hz", g.derivative_cutoff_hz}};
}

/// Gains with the worst of their margins over the range; a factor that may be any is null.
report::Json loopJson(const control::PidGains& gains, const LoopMargins& m, double kick_N) {
  report::Json j = {{"gains", gainsJson(gains)}, {"stable", m.stable}, {"count_changes_force_N", kick_N}};
  if (!m.stable) return j;
  j["gain_up"] = report::jsonNumber(m.gain_up);
  j["gain_down"] = m.gain_down;
  j["phase_rad"] = m.phase_rad;
  j["delay_s"] = m.delay_s;
  j["sensitivity"] = m.sensitivity;
  j["crossover_hz"] = m.crossover_hz;
  return j;
}

report::Json plantJson(const AxisPlant& p) {
  return {{"mass_kg", p.mass_kg}, {"viscous_N_s_per_m", p.viscous_N_s_per_m}, {"delay_s", p.delay_s}};
}

/// What the program prints of an axis, and the numbers in it.
report::Json axisJson(const TuningResults& r, std::size_t i) {
  const TunedAxis& a = r.axes[i];
  report::Json words = report::Json::array();
  for (const auto& [title, text] : wordsOf(r, i))
    words.push_back({title, text});
  report::Json j = {{"name", a.name}, {"driver", a.driver}, {"judged", a.reason.empty()}, {"in_words", words}};
  if (!a.reason.empty()) return j;
  const identification::AxisResponse& x = r.responses.axes[i];
  j["measured"] = {{"mass_kg", x.mass_kg},       {"mass_std_kg", x.mass_std}, {"delay_s", x.delay_s},
                   {"delay_std_s", x.delay_std}, {"coulomb_N", x.coulomb_N},  {"explained", x.explained}};
  j["range"] = {{"low", plantJson(a.range.low)},
                {"high", plantJson(a.range.high)},
                {"highest_crossover_hz", a.highest_crossover_hz}};
  j["present"] = loopJson(a.present, a.present_worst, a.present_kick_N);
  j["proposed"] = a.proposed ? loopJson(*a.proposed, a.proposed_worst, a.proposed_kick_N) : report::Json();
  return j;
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

std::string tuningJson(const TuningResults& r, const std::string& command_line) {
  report::Json j = {{"command", "tune_pid"},
                    {"recording", r.recording},
                    {"deployment", r.deployment},
                    {"servo_period_s", r.servo_period_s},
                    {"demand",
                     {{"gain", r.demand.gain},
                      {"phase_rad", r.demand.phase_rad},
                      {"sensitivity", r.demand.sensitivity},
                      {"sentence", demandText(r)}}},
                    {"axes", report::Json::array()}};
  for (std::size_t i = 0; i < r.axes.size(); ++i)
    j["axes"].push_back(axisJson(r, i));
  j["reproduce"] = command_line;
  return j.dump(2, ' ', false, report::Json::error_handler_t::replace) + "\n";
}

void writeTuning(const TuningResults& r, const std::string& command_line, const std::string& folder) {
  const report::Page page("tune_pid");
  makeFolder(folder);
  FileSet files;
  report::addReport(files, folder, page, tuningJson(r, command_line), tuningSeries(r));
  files.add(folder + "/gains.yaml", gainsFile(r));
  files.commit();
}

}  // namespace knee_robot::tuning
