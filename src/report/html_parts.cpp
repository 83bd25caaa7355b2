#include "html_parts.h"

#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/report/svg_plot.h"

namespace knee_robot::report {
namespace {

constexpr const char* kStyle = R"(<style>
body{font:15px/1.5 system-ui,sans-serif;color:#222;max-width:1040px;margin:2em auto;padding:0 1em}
h1{font-size:1.6em;margin-bottom:.2em}h2{font-size:1.25em;margin-top:2em;border-bottom:1px solid #ccc}h3{font-size:1.05em;margin:1.4em 0 .2em}
table{border-collapse:collapse;margin:.6em 0;font-variant-numeric:tabular-nums}
th,td{padding:.2em .8em;text-align:right;border-bottom:1px solid #e3e3e3}
th{font-weight:600;border-bottom:1px solid #999}td:first-child,th:first-child{text-align:left}
tr.group td{font-weight:600;background:#f4f4f4}td.text,th.text{text-align:left;overflow-wrap:anywhere}
svg{width:100%;height:auto;display:block;font:12px system-ui,sans-serif;fill:#333}
svg .grid{stroke:#e6e6e6}svg .frame{fill:none;stroke:#888}svg .line{fill:none;stroke-width:1.4}
svg .shade{fill:#f3efe2}svg .marker{stroke:#333;stroke-dasharray:4 3}
.key{color:#555;font-size:.92em}.verdict{font-size:1.1em;background:#f4f4f4;padding:.6em 1em}
.silent td{color:#888}summary{cursor:pointer;margin:.6em 0}
code{background:#f4f4f4;padding:.1em .3em;word-break:break-all}li{margin:.2em 0}
@media print{body{max-width:none;font-size:11px}svg,table{break-inside:avoid}}
</style>
)";

}  // namespace

std::string pageHead(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escapeHtml(title) + "</title>\n" +
         kStyle + "</head><body>\n<h1>" + escapeHtml(title) + "</h1>\n";
}

std::string htmlNumber(double value) {
  return std::isfinite(value) ? shortNumber(value, 3) : std::string("&ndash;");
}

std::string tableHead(const std::string& first, int axes) {
  std::string out = "<table><tr><th>" + first + "</th>";
  for (int i = 1; i <= axes; ++i)
    out += "<th>actuator " + std::to_string(i) + "</th>";
  return out + "</tr>\n";
}

std::string tableRow(const std::string& name, const Eigen::VectorXd& values) {
  std::string out = "<tr><td>" + escapeHtml(name) + "</td>";
  for (const double value : values)
    out += "<td>" + htmlNumber(value) + "</td>";
  return out + "</tr>\n";
}

std::string tableGroup(const std::string& title, int axes) {
  return "<tr class=\"group\"><td colspan=\"" + std::to_string(axes + 1) + "\">" + escapeHtml(title) + "</td></tr>\n";
}

std::string sentenceList(const std::string& title, const std::vector<std::string>& sentences) {
  if (sentences.empty()) return {};
  std::string out = "<h2>" + title + "</h2>\n<ul>\n";
  for (const std::string& s : sentences)
    out += "<li>" + escapeHtml(s) + "</li>\n";
  return out + "</ul>\n";
}

std::string singleRecordingNote(std::size_t recordings) {
  if (recordings != 1) return {};
  return "<p>There was a single training recording: every choice rests on contiguous parts of it, and evidence across "
         "trajectories was not available.</p>\n";
}

std::string pageEnd(const std::string& command_line) {
  return "<h2>Reproduce</h2>\n<p><code>" + escapeHtml(command_line) + "</code></p>\n</body></html>\n";
}

std::vector<double> series(const Eigen::MatrixXd& matrix, int column) {
  const Eigen::VectorXd values = matrix.col(column);
  return {values.data(), values.data() + values.size()};
}

std::vector<std::pair<double, double>> movingStretches(const identification::Observation& o) {
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

}  // namespace knee_robot::report
