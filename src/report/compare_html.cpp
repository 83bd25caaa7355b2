#include <cmath>

#include "compare_panels.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/svg_plot.h"

namespace knee_robot::report {
namespace {

constexpr double kPerMetre = 1e3;
constexpr double kPerRadian = 180.0 / 3.14159265358979323846;

const char* const kCoordinates[4] = {"X", "Z", "theta", "psi"};

constexpr const char* kStyle = R"(<style>
body{font:15px/1.5 system-ui,sans-serif;color:#222;max-width:1040px;margin:2em auto;padding:0 1em}
h1{font-size:1.6em;margin-bottom:.2em}h2{font-size:1.25em;margin-top:2em;border-bottom:1px solid #ccc}h3{font-size:1.05em;margin:1.4em 0 .2em}
table{border-collapse:collapse;margin:.6em 0;font-variant-numeric:tabular-nums}
th,td{padding:.2em .8em;text-align:right;border-bottom:1px solid #e3e3e3}
th{font-weight:600;border-bottom:1px solid #999}td:first-child,th:first-child{text-align:left;width:29em}td,th{min-width:4em}
svg{width:100%;height:auto;display:block;font:12px system-ui,sans-serif;fill:#333}
svg .grid{stroke:#e6e6e6}svg .frame{fill:none;stroke:#888}svg .line{fill:none;stroke-width:1.4}
svg .shade{fill:#f3efe2}svg .marker{stroke:#333;stroke-dasharray:4 3}
.key{color:#555;font-size:.92em}code{background:#f4f4f4;padding:.1em .3em;word-break:break-all}li{margin:.2em 0}
</style>
)";

double unitOf(int coordinate) {
  return coordinate < 2 ? kPerMetre : kPerRadian;
}

std::string cell(double value) {
  const double shown = std::abs(value) < 1e-6 ? 0.0 : value;  // means that the fit made zero
  return "<td>" + (std::isfinite(value) ? shortNumber(shown, 3) : std::string("&ndash;")) + "</td>";
}

/// One row of the table of errors. `factor` brings the figures to mm or deg.
std::string errorRow(const std::string& name, const char* unit, const ErrorFigures& e, double factor,
                     const std::string& last_cells) {
  return "<tr><td>" + name + ", " + unit + "</td>" + cell(factor * e.max_abs) + cell(e.time_of_max_s) +
         cell(factor * e.rms) + cell(factor * e.mean) + last_cells + "</tr>\n";
}

constexpr const char* kErrorHead = "<th>largest</th><th>at, s</th><th>rms</th><th>mean</th>";

std::string paperTable(const CompareResults& r) {
  std::string out = std::string("<h2>Errors beside the paper's</h2>\n<table><tr><th>measured minus reference</th>") +
                    kErrorHead + "<th>paper, largest</th></tr>\n";
  for (std::size_t i = 0; i < r.actuators.size(); ++i) {
    const bool leg = r.has_pose;
    out += errorRow((leg ? "leg " : "axis ") + std::to_string(i + 1), "mm", r.actuators[i], kPerMetre,
                    std::string("<td>") + (leg ? kPaperFigures[i].paper : "&ndash;") + "</td>");
  }
  for (int k = 0; r.has_pose && k < 4; ++k) {
    out += errorRow(kCoordinates[k], kPaperFigures[4 + k].unit, r.pose[k], unitOf(k),
                    std::string("<td>") + kPaperFigures[4 + k].paper + "</td>");
  }
  out += "</table>\n";
  if (r.has_pose) {
    out +=
        "<p class=\"key\">Pose: forward kinematics of the measured lengths minus that of the reference. The paper's "
        "figures are "
        "those of the text to its Figs. 15 and 16, of another machine and movement.</p>\n";
  }
  return out;
}

/// Panels below each other, each title once.
std::string panelsHtml(const std::vector<ComparePanel>& panels) {
  std::string out, last;
  for (const ComparePanel& p : panels) {
    if (p.title != last) out += "<h3>" + p.title + "</h3>\n";
    last = p.title;
    out += p.svg;
  }
  return out;
}

std::string actuatorPlots(const CompareResults& r) {
  return (r.has_pose ? "<h2>Actuators (the paper's Fig. 15)</h2>\n" : "<h2>Axes</h2>\n") +
         panelsHtml(actuatorPanels(r));
}

std::string posePlots(const CompareResults& r) {
  const bool regular = singularStretches(r).empty();
  return std::string("<h2>Pose (the paper's Fig. 16)</h2>\n<p class=\"key\">") +
         (regular ? "The condition of the Jacobian stays below "
                  : "Shaded: the condition of the Jacobian (m, rad) is above ") +
         shortNumber(r.condition_max) + ".</p>\n" + panelsHtml(posePanels(r));
}

std::string cameraTable(const char* title, const ErrorFigures (&errors)[4]) {
  std::string out = std::string("<table><tr><th>") + title + "</th>" + kErrorHead + "<th>rows</th></tr>\n";
  for (int k = 0; k < 4; ++k) {
    out += errorRow(kCoordinates[k], kPaperFigures[4 + k].unit, errors[k], unitOf(k),
                    "<td>" + std::to_string(errors[k].rows) + "</td>");
  }
  return out + "</table>\n";
}

std::string cameraSection(const CompareResults& r) {
  const tracing::CameraAlignment& a = r.camera.alignment;
  std::string out = "<h2>Camera</h2>\n<table><tr><th>alignment, fixed over the recording</th><th></th></tr>\n";
  const auto row = [&](const std::string& what, const std::string& value) {
    out += "<tr><td>" + what + "</td><td>" + value + "</td></tr>\n";
  };
  row("delay of the camera (cross-correlation of velocities)",
      a.delay_known ? shortNumber(1e3 * a.delay_s, 3) + " ms" : "not determined, 0 assumed");
  row("correlation at that delay", shortNumber(a.correlation, 4));
  row("turn of its frame about Y", shortNumber(kPerRadian * a.rotation_rad, 3) + " deg");
  row("shift of its frame, X", shortNumber(kPerMetre * a.shift_x_m, 3) + " mm");
  row("shift of its frame, Z", shortNumber(kPerMetre * a.shift_z_m, 3) + " mm");
  row("turn of the markers about the platform's normal", shortNumber(kPerRadian * a.plate_rad, 3) + " deg");
  row("rows that the rigid fit rests on", std::to_string(a.rows));
  out += "</table>\n";
  out += cameraTable("camera minus encoders, all rows", r.camera.error);
  out += cameraTable("camera minus encoders, away from singularities", r.camera.error_regular);
  if (r.camera.other_solution > 0)
    out += cameraTable("camera minus the nearer pose with these lengths", r.camera.error_nearest);
  return out + cameraTable("camera minus reference, all rows", r.camera.reference_error);
}

std::string notesSection(const CompareResults& r) {
  if (r.notes.empty()) return "";
  std::string out = "<h2>Notes</h2>\n<ul>\n";
  for (const std::string& note : r.notes)
    out += "<li>" + escapeHtml(note) + "</li>\n";
  return out + "</ul>\n";
}

}  // namespace

std::string compareHtml(const CompareResults& r) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Reference against measured</title>\n";
  out += kStyle;
  out += "</head><body>\n<h1>Reference against measured: " + escapeHtml(r.recording.name) +
         "</h1>\n<p class=\"key\">Robot " + escapeHtml(r.robot_path) + " &middot; " +
         std::to_string(r.recording.rows()) + " rows, " +
         shortNumber(r.recording.time_s.back() - r.recording.time_s.front(), 3) + " s</p>\n";
  out += paperTable(r);
  if (r.has_camera) out += cameraSection(r);
  out += notesSection(r) + actuatorPlots(r);
  if (r.has_pose) out += posePlots(r);
  out += "<h2>Reproduce</h2>\n<p><code>" + escapeHtml(r.command_line) + "</code></p>\n";
  return out + "</body></html>\n";
}

}  // namespace knee_robot::report
