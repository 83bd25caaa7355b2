#include <cmath>

#include "friction_html.h"
#include "html_parts.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/svg_plot.h"
#include "knee_robot/report/trace_report.h"
#include "trace_angles_report.h"
#include "trace_given_report.h"
#include "trace_next_report.h"
#include "trace_pose_report.h"

namespace knee_robot::report {
namespace {

std::string errorRows(const std::string& title, const std::vector<identification::Observation>& observations,
                      const identification::Applied& before, const identification::Applied& after) {
  const int axes = observations.front().axes();
  const identification::Accuracy &b = before.accuracy, &a = after.accuracy;
  const GainInterval gain = bootstrapGain(observations, before, after, 1);
  std::string out = tableGroup(title, axes);
  out += tableRow("before: rms, all samples, N", b.rms_N) + tableRow("after: rms, all samples, N", a.rms_N);
  out += tableRow("change of rms, lower end of 95 %, N", gain.low_N) +
         tableRow("change of rms, upper end of 95 %, N", gain.high_N);
  out += tableRow("before: rms / rms of the force, %", b.rms_percent) +
         tableRow("after: rms / rms of the force, %", a.rms_percent);
  Eigen::VectorXd together(2);
  together << b.togetherPercent(), a.togetherPercent();
  out += tableRow("before, after: rms / rms of the force, all actuators together, %", together);
  out += tableRow("before: rms, moving samples, N", b.rms_moving_N) +
         tableRow("after: rms, moving samples, N", a.rms_moving_N);
  return out + tableRow("before: largest error, N", b.max_N) + tableRow("after: largest error, N", a.max_N);
}

std::string errorSection(const TraceResults& r) {
  const int axes = r.train.front().axes();
  std::string out = "<h2>Errors before and after</h2>\n" + tableHead("", axes);
  if (!r.validate.empty()) out += errorRows("Validation", r.validate, r.validate_before, r.validate_after);
  out += errorRows("Training", r.train, r.train_before, r.train_after);
  out += tableGroup("Floor", axes) + tableRow("noise floor, N", r.result.floor_N) + "</table>\n";
  return out + "<p class=\"key\">Floor: " + escapeHtml(r.result.floor_source) +
         (r.result.given.path.empty() ? ". Before: rigid body, Coulomb, viscous, rotor, offset. Both sides"
                                      : ". Before: the given model, unchanged. Both sides") +
         " low-passed at " + htmlNumber(r.options.observation.cutoff_hz) +
         " Hz. Intervals: bootstrap over blocks of 2 s.</p>\n";
}

std::string parameterText(const dynamics::ModelEffect& m) {
  std::string out;
  if (!m.depends_on.empty()) return escapeHtml("depends on " + m.depends_on);
  for (const auto* list : {&m.shape, &m.coefficients}) {
    for (const dynamics::EffectParameter& p : *list) {
      out += (out.empty() ? "" : "<br>") + escapeHtml(p.name) + " = " + shortNumber(p.value, 3);
      if (std::isfinite(p.std)) out += " &plusmn; " + shortNumber(p.std, 2);
    }
  }
  return out;
}

std::string effectSection(const TraceResults& r) {
  if (r.result.effects.empty()) return {};
  std::string out =
      "<h2>Effects</h2>\n<table><tr><th>effect</th><th>actuator</th><th>parameters</th><th>explains, N</th>"
      "<th>surrogates explain at most, N</th><th>p</th><th>held-back gain</th><th>gain on validation, N</th>"
      "<th>cannot be told from</th></tr>\n";
  for (std::size_t k = 0; k < r.result.effects.size(); ++k) {
    const tracing::FoundEffect& e = r.result.effects[k];
    const dynamics::ModelEffect& m = r.model.effects[k];
    Eigen::Index at = e.hypothesis.place.actuator;
    const bool shared = at < 0;
    if (shared) e.explained_rms_N.maxCoeff(&at);
    out +=
        "<tr><td>" + escapeHtml(m.name) + (m.transfers ? "" : " (does not transfer)") + "</td><td>" +
        (shared ? "all" : std::to_string(at + 1)) + "</td><td class=\"text\">" + parameterText(m) + "</td><td>" +
        htmlNumber(e.explained_rms_N[at]) + "</td><td>" + htmlNumber(e.null_rms_N[at]) + "</td><td>" + htmlNumber(e.p) +
        "</td><td>" + htmlNumber(100.0 * e.gain) + " &plusmn; " + htmlNumber(100.0 * e.gain_error) + " %</td><td>" +
        (k < r.validate_gain_N.size() ? htmlNumber(r.validate_gain_N[k][at]) : "&ndash;") + "</td><td class=\"text\">";
    for (const std::string& name : e.indistinguishable_from)
      out += escapeHtml(name) + " ";
    out += "</td></tr>\n<tr><td colspan=\"9\" class=\"text key\">" +
           escapeHtml(e.hypothesis.place.candidate->sentence()) + "</td></tr>\n";
  }
  return out + "</table>\n";
}

/// Mean of y in equal bins of x, the ends at the 1 % quantiles; empty bins interrupt the line.
PlotLine binned(const std::string& label, const std::string& color, const Eigen::VectorXd& x,
                const Eigen::VectorXd& y) {
  constexpr int kBins = 60;
  std::vector<double> sorted(x.data(), x.data() + x.size());
  std::sort(sorted.begin(), sorted.end());
  const double low = sorted[sorted.size() / 100], high = sorted[sorted.size() - 1 - sorted.size() / 100];
  PlotLine line{label, color, {}, {}};
  if (!(high > low)) return line;
  std::vector<double> sum(kBins, 0.0), count(kBins, 0.0);
  for (Eigen::Index n = 0; n < x.size(); ++n) {
    if (x[n] < low || x[n] > high) continue;
    const std::size_t bin =
        std::min<std::size_t>(kBins - 1, static_cast<std::size_t>(kBins * (x[n] - low) / (high - low)));
    sum[bin] += y[n];
    count[bin] += 1.0;
  }
  for (std::size_t b = 0; b < sum.size(); ++b) {
    line.x.push_back(low + (static_cast<double>(b) + 0.5) * (high - low) / kBins);
    line.y.push_back(count[b] > 4.0 ? sum[b] / count[b] : std::nan(""));
  }
  return line;
}

std::string residualMaps(const identification::Observation& o, const identification::Prediction& before,
                         const identification::Prediction& after) {
  std::string out;
  for (int i = 0; i < o.axes(); ++i) {
    const Eigen::VectorXd b = o.force_filtered_N.col(i) - before.force_filtered_N.col(i);
    const Eigen::VectorXd a = o.force_filtered_N.col(i) - after.force_filtered_N.col(i);
    out += "<h3>Actuator " + std::to_string(i + 1) + "</h3>\n";
    PlotStyle style;
    style.height = 170.0;
    style.y_label = "mean residual, N";
    style.x_label = "velocity, m/s";
    const Eigen::VectorXd v = o.signals.velocity_m_per_s.col(i);
    out += svgPlot({binned("before", kBeforeColor, v, b), binned("after", kModelColor, v, a)}, style);
    style.x_label = "position, m";
    const Eigen::VectorXd q = o.signals.position_m.col(i);
    out += svgPlot({binned("before", kBeforeColor, q, b), binned("after", kModelColor, q, a)}, style);
  }
  return out;
}

std::string timePlots(const std::string& kind, const identification::Observation& o,
                      const identification::Prediction& before, const identification::Prediction& after) {
  std::string out = "<h2>" + kind + ": " + escapeHtml(o.name) + "</h2>\n";
  PlotStyle style;
  style.x_label = "time, s";
  for (int i = 0; i < o.axes(); ++i) {
    const std::vector<double>& t = o.signals.time_s;
    out += "<h3>Actuator " + std::to_string(i + 1) + "</h3>\n";
    style.height = 200.0;
    style.y_label = "force, N";
    out += svgPlot({{"measured", kMeasuredColor, t, series(o.force_filtered_N, i)},
                    {"predicted after", kModelColor, t, series(after.force_filtered_N, i)}},
                   style);
    style.height = 160.0;
    style.y_label = "residual, N";
    out += svgPlot({{"before", kBeforeColor, t, series(o.force_filtered_N - before.force_filtered_N, i)},
                    {"after", kModelColor, t, series(o.force_filtered_N - after.force_filtered_N, i)}},
                   style);
  }
  return out;
}

}  // namespace

std::string traceHtml(const TraceResults& r) {
  std::string out = pageHead("Traced residual");
  out += "<p class=\"key\">Robot " + escapeHtml(r.robot_path) + " &middot; " + std::to_string(r.train.size()) +
         " training and " + std::to_string(r.validate.size()) + " validation recording(s) &middot; seed " +
         std::to_string(r.options.seed) + "</p>\n";
  out += "<p class=\"verdict\">" + escapeHtml(traceOutcome(r)) + " " + escapeHtml(traceVerdict(r)) + "</p>\n";
  out += effectSection(r) + givenModelHtml(r.result.given) + nextExperimentHtml(r.next) + errorSection(r) +
         errorSharesHtml(r) + frictionHtml(r.model.friction, r.result.baseline.choices) + anglesHtml(r) +
         tracePoseHtml(r.pose);
  const bool validated = !r.validate.empty();
  const identification::Observation& shown = validated ? r.validate.front() : r.train.front();
  const identification::Applied& before = validated ? r.validate_before : r.train_before;
  const identification::Applied& after = validated ? r.validate_after : r.train_after;
  out += "<h2>Residual against velocity and position, " + std::string(validated ? "validation" : "training") + ": " +
         escapeHtml(shown.name) + "</h2>\n<p class=\"key\">Means over bins, all samples.</p>\n";
  out += residualMaps(shown, before.predictions.front(), after.predictions.front());
  for (std::size_t k = 0; k < r.validate.size(); ++k)
    out += timePlots("Validation", r.validate[k], r.validate_before.predictions[k], r.validate_after.predictions[k]);
  for (std::size_t k = 0; k < r.train.size(); ++k)
    out += timePlots("Training", r.train[k], r.train_before.predictions[k], r.train_after.predictions[k]);
  out += sentenceList("Absorbed by the baseline", r.result.absorbed);
  out += sentenceList("Looked at and not added", r.result.rejected);
  out += sentenceList("How the surrogates were made", r.result.notes);
  return out + singleRecordingNote(r.train.size()) + pageEnd(r.command_line);
}

}  // namespace knee_robot::report
