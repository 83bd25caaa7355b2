#include "src/report/svg_plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test/report/count.h"

namespace knee_robot::report {
namespace {

PlotLine ramp(std::size_t n) {
  PlotLine line{"a & b", "red", {}, {}};
  for (std::size_t i = 0; i < n; ++i) {
    line.x.push_back(static_cast<double>(i));
    line.y.push_back(std::sin(0.01 * static_cast<double>(i)));
  }
  return line;
}

TEST(SvgPlot, DrawsEveryLineAndEscapesLabels) {
  PlotStyle style;
  style.y_label = "force <N>";
  const std::string svg = svgPlot({ramp(100), ramp(50)}, style);
  EXPECT_EQ(svg.rfind("<svg ", 0), 0u);
  EXPECT_EQ(count(svg, "</svg>"), 1u);
  EXPECT_EQ(count(svg, "a &amp; b"), 2u);
  EXPECT_EQ(count(svg, "force &lt;N&gt;"), 2u);  // label and description
  EXPECT_EQ(count(svg, "<N>"), 0u);
  EXPECT_EQ(count(svg, "nan") + count(svg, "inf"), 0u);
}

TEST(SvgPlot, ThinsLongLinesButKeepsTheirPeaks) {
  PlotLine line = ramp(100000);
  line.y[54321] = 50.0;
  PlotStyle style;
  const std::string svg = svgPlot({line}, style);
  EXPECT_LT(svg.size(), 80000u);
  PlotLine flat = ramp(100000);
  EXPECT_NE(svgPlot({flat}, style), svg);
  // The peak is the top of the frame's data: 5 % below its upper edge, 22 + (260 - 62) * 0.05 / 1.1 = 31 px.
  EXPECT_NE(svg.find(" 31.0"), std::string::npos);
}

TEST(SvgPlot, InterruptsTheLineWhereThereIsNoValue) {
  PlotLine line = ramp(10);
  line.y[5] = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = svgPlot({line}, {});
  const std::size_t from = svg.find("stroke=\"red\" d=\"");
  const std::string path = svg.substr(from + 16, svg.find('"', from + 16) - from - 16);
  EXPECT_EQ(count(path, "M"), 2u);
}

TEST(SvgPlot, SurvivesEmptyAndConstantData) {
  for (const std::vector<PlotLine>& lines :
       {std::vector<PlotLine>{}, std::vector<PlotLine>{{"x", "red", {1, 2}, {3, 3}}},
        std::vector<PlotLine>{{"x", "red", {1}, {0}}}}) {
    const std::string svg = svgPlot(lines, {});
    EXPECT_EQ(count(svg, "nan") + count(svg, "inf"), 0u) << svg;
    EXPECT_EQ(count(svg, "</svg>"), 1u);
  }
}

TEST(SvgPlot, AValueThatDiffersByRoundingIsFlat) {
  const double one_up = std::nextafter(1.0, 2.0);  // a coherence without a reference
  const std::string svg = svgPlot({{"x", "red", {1, 2, 3}, {1.0, one_up, 1.0}}}, {});
  EXPECT_LT(svg.size(), 10000u);
  EXPECT_EQ(count(svg, "</svg>"), 1u);
}

}  // namespace
}  // namespace knee_robot::report
