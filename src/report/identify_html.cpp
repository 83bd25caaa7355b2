#include <cmath>
#include <cstdio>

#include "html_parts.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/svg_plot.h"

namespace knee_robot::report {
namespace {

std::string accuracyRows(const std::string& title, const identification::Accuracy& a) {
  const int axes = static_cast<int>(a.rms_N.size());
  std::string out = tableGroup(
      title + " (" + std::to_string(a.samples) + " samples, " + std::to_string(a.moving_samples) + " of them moving)",
      axes);
  out += tableRow("rms, moving samples, N", a.rms_moving_N) + tableRow("rms, all samples, N", a.rms_N);
  out += tableRow("rms, all rows, full band, N", a.rms_raw_N) +
         tableRow("rms / rms(force), rows, full band, %", a.raw_percent) +
         tableRow("rms / rms of the force, %", a.rms_percent);
  out +=
      tableRow("rms / rms of the force, all actuators together, %", Eigen::VectorXd::Constant(1, a.togetherPercent()));
  return out + tableRow("rms / range of the force, %", a.range_percent) + tableRow("largest error, N", a.max_N);
}

std::string accuracySection(const IdentifyResults& r) {
  std::string out = "<h2>Errors</h2>\n" + tableHead("", r.after.model.axes);
  if (!r.validate.empty()) out += accuracyRows("Validation", r.validate_after.accuracy);
  out += accuracyRows("Training", r.train_after.accuracy);
  if (r.physical) {
    if (!r.validate.empty())
      out += accuracyRows("Validation, physically consistent parameters", r.validate_physical.accuracy);
    out += accuracyRows("Training, physically consistent parameters", r.train_physical.accuracy);
  }
  if (!r.validate.empty())
    out += accuracyRows("Validation, model without actuator friction", r.validate_before.accuracy);
  out += accuracyRows("Training, model without actuator friction", r.train_before.accuracy) + "</table>\n";
  return out +
         "<p class=\"key\">Measured means commanded: no force sensor exists. Both sides pass the same zero-phase "
         "low-pass at " +
         htmlNumber(r.options.observation.cutoff_hz) +
         " Hz unless the row says otherwise. Moving: every axis faster than " +
         htmlNumber(1e3 * r.options.observation.moving_m_per_s) + " mm/s.</p>\n";
}

std::string forcePlots(const std::string& kind, const identification::Observation& o,
                       const identification::Prediction& p, const identification::Prediction& without) {
  std::string out =
      "<h2>" + kind + ": " + escapeHtml(o.name) + "</h2>\n<p class=\"key\">Shaded: every axis moves.</p>\n";
  PlotStyle style;
  style.x_label = "time, s";
  style.shaded = movingStretches(o);
  for (int i = 0; i < o.axes(); ++i) {
    const std::vector<double>& t = o.signals.time_s;
    out += "<h3>Actuator " + std::to_string(i + 1) + "</h3>\n";
    style.height = 260.0;
    style.y_label = "force, N";
    out += svgPlot({{"measured", kMeasuredColor, t, series(o.force_filtered_N, i)},
                    {"predicted", kModelColor, t, series(p.force_filtered_N, i)}},
                   style);
    style.height = 170.0;
    style.y_label = "residual, N";
    out +=
        svgPlot({{"without friction model", kBeforeColor, t, series(o.force_filtered_N - without.force_filtered_N, i)},
                 {"identified model", kModelColor, t, series(o.force_filtered_N - p.force_filtered_N, i)}},
                style);
  }
  return out;
}

std::string rankPlot(const IdentifyResults& r, const std::vector<Eigen::VectorXd>& errors, const std::string& title) {
  std::vector<PlotLine> lines;
  for (int i = 0; i < r.after.model.axes; ++i) {
    PlotLine line{"actuator " + std::to_string(i + 1), kActuatorColors[i % 4], {}, {}};
    for (std::size_t k = 0; k < errors.size(); ++k) {
      line.x.push_back(r.after.rank.curve[k].rank);
      line.y.push_back(errors[k][i]);
    }
    lines.push_back(line);
  }
  PlotStyle style;
  style.x_label = "directions that the data decide (the prior's pull falls to the right)";
  style.y_label = "rms, moving, N";
  style.log_y = true;
  style.markers = {static_cast<double>(r.after.model.rank)};
  return "<h3>" + title + "</h3>\n" + svgPlot(lines, style);
}

std::string rankSection(const IdentifyResults& r) {
  PlotLine held{"held back", kModelColor, {}, {}}, fitted{"fitted", kMeasuredColor, {}, {}};
  for (const identification::RankPoint& p : r.after.rank.curve) {
    held.x.push_back(p.rank);
    held.y.push_back(std::sqrt(p.held_back));
    fitted.x.push_back(p.rank);
    fitted.y.push_back(std::sqrt(p.training));
  }
  PlotStyle style;
  style.x_label = "directions that the data decide (the prior's pull falls to the right)";
  style.y_label = "rms / noise";
  style.log_y = true;
  style.markers = {static_cast<double>(r.after.model.rank)};
  std::string out =
      "<h2>Error against the prior's strength</h2>\n<p>Chosen: " + std::to_string(r.after.model.rank) +
      " directions, friction and rotors included, that the data decide (dashed); the others stay near the "
      "prior. All are fitted; the pull towards the prior is the strongest whose error on held-back blocks of "
      "the training data is within one standard error of the best. " +
      std::to_string(r.after.blocks) +
      " blocks, split at stops; repeats of a stretch of motion are held back together. The validation "
      "curve is shown for judgement; it played no part.</p>\n";
  out +=
      "<h3>Blocks of the training data, all actuators, in units of the noise</h3>\n" + svgPlot({held, fitted}, style);
  out += rankPlot(r, r.train_by_rank, "Training, per actuator");
  if (!r.validate_by_rank.empty()) out += rankPlot(r, r.validate_by_rank, "Validation, per actuator");
  return out;
}

}  // namespace

std::string identifyHtml(const IdentifyResults& r) {
  std::string out = pageHead("Identified force model");
  out += "<p class=\"key\">Robot " + escapeHtml(r.robot_path) + " &middot; " + std::to_string(r.train.size()) +
         " training and " + std::to_string(r.validate.size()) + " validation recording(s) &middot; rank " +
         std::to_string(r.after.model.rank) + "</p>\n";
  out += accuracySection(r);
  for (std::size_t i = 0; i < r.validate.size(); ++i) {
    out += forcePlots("Validation", r.validate[i], r.validate_after.predictions[i], r.validate_before.predictions[i]);
  }
  for (std::size_t i = 0; i < r.train.size(); ++i) {
    out += forcePlots("Training", r.train[i], r.train_after.predictions[i], r.train_before.predictions[i]);
  }
  out += identifySpectra(r) + rankSection(r) + identifyParameters(r.after) + identifyPhysical(r) + identifySignals(r);
  return out + pageEnd(r.command_line);
}

}  // namespace knee_robot::report
