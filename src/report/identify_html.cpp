#include <cmath>
#include <cstdio>

#include "knee_robot/base/numbers.h"
#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/svg_plot.h"

namespace knee_robot {
namespace {

const char* const kColors[] = {"#1b6ca8", "#d1495b", "#2a9d55", "#8e5ea2"};
constexpr const char* kMeasured = "#1b6ca8";
constexpr const char* kPredicted = "#d1495b";
constexpr const char* kWithout = "#9a9a9a";

constexpr const char* kStyle = R"(<style>
body{font:15px/1.5 system-ui,sans-serif;color:#222;max-width:1040px;margin:2em auto;padding:0 1em}
h1{font-size:1.6em;margin-bottom:.2em}h2{font-size:1.25em;margin-top:2em;border-bottom:1px solid #ccc}h3{font-size:1.05em;margin:1.4em 0 .2em}
table{border-collapse:collapse;margin:.6em 0;font-variant-numeric:tabular-nums}
th,td{padding:.2em .8em;text-align:right;border-bottom:1px solid #e3e3e3}
th{font-weight:600;border-bottom:1px solid #999}td:first-child,th:first-child{text-align:left}
tr.group td{font-weight:600;background:#f4f4f4}td.text,th.text{text-align:left}
svg{width:100%;height:auto;display:block;font:12px system-ui,sans-serif;fill:#333}
svg .grid{stroke:#e6e6e6}svg .frame{fill:none;stroke:#888}svg .line{fill:none;stroke-width:1.4}
svg .shade{fill:#f3efe2}svg .marker{stroke:#333;stroke-dasharray:4 3}
.key{color:#555;font-size:.92em}code{background:#f4f4f4;padding:.1em .3em;word-break:break-all}li{margin:.2em 0}
</style>
)";

std::string number(double value) {
  return std::isfinite(value) ? shortNumber(value, 3) : std::string("&ndash;");
}

std::string cells(const Eigen::VectorXd& values) {
  std::string out;
  for (const double value : values)
    out += "<td>" + number(value) + "</td>";
  return out;
}

std::string tableHead(const std::string& first, int axes) {
  std::string out = "<table><tr><th>" + first + "</th>";
  for (int i = 1; i <= axes; ++i)
    out += "<th>actuator " + std::to_string(i) + "</th>";
  return out + "</tr>\n";
}

std::string accuracyRows(const std::string& title, const Accuracy& a) {
  const auto row = [](const char* name, const Eigen::VectorXd& values) {
    return std::string("<tr><td>") + name + "</td>" + cells(values) + "</tr>\n";
  };
  std::string out = "<tr class=\"group\"><td colspan=\"" + std::to_string(a.rms_N.size() + 1) + "\">" +
                    escapeHtml(title) + " (" + std::to_string(a.samples) + " samples, " +
                    std::to_string(a.moving_samples) + " of them moving)</td></tr>\n";
  out += row("rms, moving samples, N", a.rms_moving_N) + row("rms, all samples, N", a.rms_N);
  out += row("rms, all rows, force unfiltered, N", a.rms_raw_N) + row("rms / rms of the force, %", a.rms_percent);
  return out + row("rms / range of the force, %", a.range_percent) + row("largest error, N", a.max_N);
}

std::string accuracySection(const IdentifyResults& r) {
  std::string out = "<h2>Errors</h2>\n" + tableHead("", r.after.model.axes);
  if (!r.validate.empty()) out += accuracyRows("Validation", r.validate_after.accuracy);
  out += accuracyRows("Training", r.train_after.accuracy);
  if (!r.validate.empty())
    out += accuracyRows("Validation, model without actuator friction", r.validate_before.accuracy);
  out += accuracyRows("Training, model without actuator friction", r.train_before.accuracy) + "</table>\n";
  return out +
         "<p class=\"key\">Measured means commanded: no force sensor exists. Both sides pass the same zero-phase "
         "low-pass at " +
         number(r.options.observation.cutoff_hz) +
         " Hz unless the row says otherwise. Moving: every axis faster than " +
         number(1e3 * r.options.observation.moving_m_per_s) + " mm/s.</p>\n";
}

/// Stretches of time in which every axis moves.
std::vector<std::pair<double, double>> movingStretches(const Observation& o) {
  std::vector<std::pair<double, double>> out;
  for (int n = 0; n < o.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    if (!o.moving[i]) continue;
    const double t = o.signals.time_s[i];
    if (n == 0 || !o.moving[i - 1]) out.emplace_back(t, t);
    out.back().second = t;
  }
  return out;
}

std::vector<double> column(const Eigen::MatrixXd& m, int i) {
  const Eigen::VectorXd values = m.col(i);
  return {values.data(), values.data() + values.size()};
}

std::string forcePlots(const std::string& kind, const Observation& o, const Prediction& p, const Prediction& without) {
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
    out += svgPlot({{"measured", kMeasured, t, column(o.force_filtered_N, i)},
                    {"predicted", kPredicted, t, column(p.force_filtered_N, i)}},
                   style);
    style.height = 170.0;
    style.y_label = "residual, N";
    out += svgPlot({{"without friction model", kWithout, t, column(o.force_filtered_N - without.force_filtered_N, i)},
                    {"identified model", kPredicted, t, column(o.force_filtered_N - p.force_filtered_N, i)}},
                   style);
  }
  return out;
}

std::string rankPlot(const IdentifyResults& r, const std::vector<Eigen::VectorXd>& errors, const std::string& title) {
  std::vector<PlotLine> lines;
  for (int i = 0; i < r.after.model.axes; ++i) {
    PlotLine line{"actuator " + std::to_string(i + 1), kColors[i % 4], {}, {}};
    for (std::size_t k = 0; k < errors.size(); ++k) {
      line.x.push_back(r.after.rank.curve[k].rank);
      line.y.push_back(errors[k][i]);
    }
    lines.push_back(line);
  }
  PlotStyle style;
  style.x_label = "rank";
  style.y_label = "rms, moving, N";
  style.log_y = true;
  style.markers = {static_cast<double>(r.after.model.rank)};
  return "<h3>" + title + "</h3>\n" + svgPlot(lines, style);
}

std::string rankSection(const IdentifyResults& r) {
  PlotLine held{"held back", kPredicted, {}, {}}, fitted{"fitted", kMeasured, {}, {}};
  for (const RankPoint& p : r.after.rank.curve) {
    held.x.push_back(p.rank);
    held.y.push_back(std::sqrt(p.held_back));
    fitted.x.push_back(p.rank);
    fitted.y.push_back(std::sqrt(p.training));
  }
  PlotStyle style;
  style.x_label = "rank";
  style.y_label = "rms / noise";
  style.log_y = true;
  style.markers = {static_cast<double>(r.after.model.rank)};
  std::string out = "<h2>Error against rank</h2>\n<p>Chosen: " + std::to_string(r.after.model.rank) +
                    " (dashed), the smallest rank whose error on held-back blocks of the training data is within one "
                    "standard error of the best. " +
                    std::to_string(r.after.blocks) +
                    " blocks, split at stops. The validation curve is shown for judgement; it played no part.</p>\n";
  out +=
      "<h3>Blocks of the training data, all actuators, in units of the noise</h3>\n" + svgPlot({held, fitted}, style);
  out += rankPlot(r, r.train_by_rank, "Training, per actuator");
  if (!r.validate_by_rank.empty()) out += rankPlot(r, r.validate_by_rank, "Validation, per actuator");
  return out;
}

std::string parameterSection(const Identification& id) {
  std::string out =
      "<h2>Parameters</h2>\n<table><tr><th>parameter</th><th>value</th><th>standard "
      "error</th><th class=\"text\">unit</th><th class=\"text\">verdict</th></tr>\n";
  int silent = 0;
  for (const ModelParameter& p : id.model.parameters) {
    if (!std::isfinite(p.std)) {
      ++silent;
      continue;
    }
    out += "<tr><td>" + escapeHtml(p.name) + "</td><td>" + shortNumber(p.value, 4) + "</td><td>" +
           shortNumber(p.std, 3) + "</td><td class=\"text\">" + p.unit + "</td><td class=\"text\">" + p.verdict +
           "</td></tr>\n";
  }
  out += "</table>\n<p>" + std::to_string(silent) + " other parameters appear only in the " +
         std::to_string(id.model.base.size()) +
         " combinations that the data determine; model.yaml lists those. Standard errors allow for residuals that are "
         "correlated in time. "
         "Friction and rotor inertia are kept from becoming negative.</p>\n";
  out +=
      "<table><tr><th>per actuator</th><th>friction builds up over, mm</th><th>residual (training, moving), "
      "N</th></tr>\n";
  for (std::size_t i = 0; i < id.model.coulomb_width_m.size(); ++i) {
    out += "<tr><td>" + std::to_string(i + 1) + "</td><td>" + shortNumber(1e3 * id.model.coulomb_width_m[i], 3) +
           "</td><td>" + shortNumber(id.model.residual_rms_N[i], 3) + "</td></tr>\n";
  }
  return out + "</table>\n";
}

std::string notesSection(const IdentifyResults& r) {
  std::string out = "<h2>What was done with the signals</h2>\n";
  for (const auto* group : {&r.train, &r.validate}) {
    for (const Observation& o : *group) {
      out += "<h3>" + escapeHtml(o.path) + "</h3>\n<ul>\n";
      for (const std::string& note : o.notes)
        out += "<li>" + escapeHtml(note) + "</li>\n";
      out += "</ul>\n";
    }
  }
  const ObservationOptions& options = r.options.observation;
  out += "<ul><li>Positions: zero-phase low-pass at " + number(options.signals.motion_cutoff_hz) +
         " Hz, then five-point differences. Both sides of the equation: zero-phase low-pass (4th-order Butterworth, "
         "forward and backward) at " +
         number(options.cutoff_hz) + " Hz.</li>\n<li>Fitted: " + std::to_string(r.after.equations) +
         " equations from " + number(r.after.duration_s) + " s of motion; " + number(100.0 * r.after.outlier_share) +
         " % of them lie beyond 1.345 times the noise and count less (Huber).</li>\n<li>Coulomb friction keeps its "
         "last value at rest and "
         "builds up over the stated displacement, so stops need no sign of the velocity.</li></ul>\n";
  if (r.train.size() == 1) {
    out +=
        "<p>There was a single training recording: every choice rests on contiguous parts of it, and evidence across "
        "trajectories was not available.</p>\n";
  }
  return out;
}

}  // namespace

std::string identifyHtml(const IdentifyResults& r) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Identified force model</title>\n";
  out += kStyle;
  out += "</head><body>\n<h1>Identified force model</h1>\n<p class=\"key\">Robot " + escapeHtml(r.robot_path) +
         " &middot; " + std::to_string(r.train.size()) + " training and " + std::to_string(r.validate.size()) +
         " validation recording(s) &middot; rank " + std::to_string(r.after.model.rank) + "</p>\n";
  out += accuracySection(r);
  for (std::size_t i = 0; i < r.validate.size(); ++i) {
    out += forcePlots("Validation", r.validate[i], r.validate_after.predictions[i], r.validate_before.predictions[i]);
  }
  for (std::size_t i = 0; i < r.train.size(); ++i) {
    out += forcePlots("Training", r.train[i], r.train_after.predictions[i], r.train_before.predictions[i]);
  }
  out += rankSection(r) + parameterSection(r.after) + notesSection(r);
  out += "<h2>Reproduce</h2>\n<p><code>" + escapeHtml(r.command_line) + "</code></p>\n";
  return out + "</body></html>\n";
}

}  // namespace knee_robot
