#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/report/svg_plot.h"
#include "trace_pose_report.h"

namespace knee_robot::report {
namespace {

constexpr const char* kBefore = "#9a9a9a";
constexpr const char* kAfter = "#d1495b";
constexpr double kDegrees = 180.0 / 3.14159265358979323846;

double unitOf(int k) {
  return k < 2 ? 1e3 : kDegrees;
}

std::string errorRow(const std::string& name, const tracing::PoseErrors& e) {
  std::string out = "<tr><td>" + escapeHtml(name) + "</td>";
  for (int k = 0; k < 4; ++k)
    out += "<td>" + shortNumber(unitOf(k) * e.rms[k], 3) + "</td>";
  for (int k = 0; k < 4; ++k)
    out += "<td>" + shortNumber(unitOf(k) * e.max[k], 3) + "</td>";
  return out + "</tr>\n";
}

std::string table(const tracing::PoseTrace& pose) {
  std::string out =
      "<table><tr><th>camera minus encoders</th><th>X rms, mm</th><th>Z, mm</th><th>theta, deg</th><th>psi, deg</th>"
      "<th>X largest, mm</th><th>Z, mm</th><th>theta, deg</th><th>psi, deg</th></tr>\n";
  for (const auto& [kind, recordings] :
       {std::pair{"Training: ", &pose.train}, std::pair{"Validation: ", &pose.validate}}) {
    for (const tracing::PoseRecording& r : *recordings) {
      out += "<tr class=\"group\"><td colspan=\"9\">" + (kind + escapeHtml(r.name)) + "</td></tr>\n";
      out += errorRow("before: one fixed transform", r.before) + errorRow("after", r.after) +
             errorRow("after, with this recording's own transform and delay", r.refitted);
    }
  }
  out +=
      "</table>\n<p class=\"key\">The transform (turn about Y, shift in X and Z, turn of the markers about the "
      "platform's normal) and all explanations are fitted on training recordings. Noise of single pictures: " +
      shortNumber(1e3 * pose.noise[0], 2) + " mm, " + shortNumber(1e3 * pose.noise[1], 2) + " mm, " +
      shortNumber(kDegrees * pose.noise[2], 2) + " deg, " + shortNumber(kDegrees * pose.noise[3], 2) +
      " deg. Rows with a condition above " + shortNumber(pose.condition_max, 3) + " are left out.</p>\n";
  return out;
}

std::string findings(const tracing::PoseTrace& pose) {
  if (pose.findings.empty()) return "<p>No explanation of the pose beats surrogates; nothing was added.</p>\n";
  std::string out =
      "<table><tr><th>explanation</th><th>size</th><th>explains, % of the square</th><th>surrogates at most, %</th>"
      "<th>p</th><th>held-back gain</th><th>cannot be told from</th></tr>\n";
  for (const tracing::PoseFinding& f : pose.findings) {
    const std::string parameter = tracing::parameterOf(f.hypothesis);
    const bool angle = parameter.find("_rad") != std::string::npos;
    const double factor = angle ? kDegrees : 1e3;
    out += "<tr><td>" + escapeHtml(tracing::textOf(f.hypothesis)) +
           (f.transfers ? "" : " (does not transfer: home is set anew at every start)") + "</td><td>" +
           shortNumber(factor * f.value, 3) + " &plusmn; " + shortNumber(factor * f.std, 2) + (angle ? " deg" : " mm") +
           "</td><td>" + shortNumber(100.0 * f.share, 3) + "</td><td>" + shortNumber(100.0 * f.null_share, 2) +
           "</td><td>" + shortNumber(f.p, 2) + "</td><td>" + shortNumber(100.0 * f.gain, 3) + " &plusmn; " +
           shortNumber(100.0 * f.gain_error, 2) + " %</td><td class=\"text\">";
    for (const tracing::PoseHypothesis& h : f.confusable)
      out += escapeHtml(tracing::textOf(h)) + "<br>";
    out += "</td></tr>\n";
  }
  return out + "</table>\n";
}

std::vector<double> column(const Eigen::MatrixXd& m, int k) {
  const Eigen::VectorXd values = unitOf(k) * m.col(k);
  return {values.data(), values.data() + values.size()};
}

std::string plots(const tracing::PoseRecording& r) {
  static const char* const kNames[4] = {"X, mm", "Z, mm", "theta, deg", "psi, deg"};
  std::string out = "<h3>" + escapeHtml(r.name) + "</h3>\n";
  PlotStyle style;
  style.x_label = "time, s";
  style.height = 150.0;
  for (int k = 0; k < 4; ++k) {
    style.y_label = kNames[k];
    out += svgPlot({{"before", kBefore, r.time_s, column(r.before_error, k)},
                    {"after", kAfter, r.time_s, column(r.after_error, k)}},
                   style);
  }
  return out;
}

std::string list(const std::string& title, const std::vector<std::string>& sentences) {
  if (sentences.empty()) return {};
  std::string out = "<h3>" + title + "</h3>\n<ul>\n";
  for (const std::string& s : sentences)
    out += "<li>" + escapeHtml(s) + "</li>\n";
  return out + "</ul>\n";
}

}  // namespace

std::string tracePoseHtml(const tracing::PoseTrace& pose) {
  if (!pose.available) return {};
  std::string out = "<h2>Pose: camera against encoders</h2>\n" + findings(pose) + table(pose);
  for (const tracing::PoseRecording& r : pose.validate)
    out += plots(r);
  for (const tracing::PoseRecording& r : pose.train)
    out += plots(r);
  return out + list("Notes on the pose", pose.notes) + list("Taken up by the camera transform", pose.absorbed) +
         list("Looked at for the pose and not added", pose.rejected);
}

}  // namespace knee_robot::report
