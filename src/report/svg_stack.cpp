#include "knee_robot/base/numbers.h"
#include "svg_plot.h"

namespace knee_robot::report {
namespace {

constexpr double kTitle = 64.0;

constexpr const char* kStyle =
    "<style>svg{font:12px sans-serif;fill:#333}.grid{stroke:#e6e6e6}.frame{fill:none;stroke:#888}"
    ".line{fill:none;stroke-width:1.4}.shade{fill:#f3efe2}.marker{stroke:#333;stroke-dasharray:4 3}"
    ".title{font-size:17px;font-weight:600}</style>\n";

std::string textAt(double y, const char* attributes, const std::string& content) {
  return "<text x=\"64\" y=\"" + shortNumber(y) + "\" " + attributes + ">" + escapeHtml(content) + "</text>\n";
}

}  // namespace

std::string stackedSvg(const std::string& title, const std::vector<std::string>& plots, double width,
                       const std::vector<double>& heights) {
  double height = kTitle;
  for (const double h : heights)
    height += h;
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + shortNumber(width) + " " +
                    shortNumber(height) + "\" width=\"" + shortNumber(width) + "\" height=\"" + shortNumber(height) +
                    "\">\n" + kStyle + "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  const std::size_t end = title.find('\n');
  out += textAt(26, "class=\"title\"", title.substr(0, end));
  if (end != std::string::npos) out += textAt(48, "", title.substr(end + 1));
  double y = kTitle;
  for (std::size_t k = 0; k < plots.size(); ++k) {
    out += "<svg x=\"0\" y=\"" + shortNumber(y) + "\" width=\"" + shortNumber(width) + "\" height=\"" +
           shortNumber(heights[k]) + "\" " + plots[k].substr(5);  // behind "<svg "
    y += heights[k];
  }
  return out + "</svg>\n";
}

}  // namespace knee_robot::report
