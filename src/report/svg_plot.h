#pragma once

#include <string>
#include <utility>
#include <vector>

namespace knee_robot::report {

/// One line of a plot. x and y have the same length; points that are not finite interrupt the line.
struct PlotLine {
  std::string label;
  std::string color;  ///< any CSS colour
  std::vector<double> x;
  std::vector<double> y;
};

/// Appearance of a plot. Sizes in px of the drawing, which scales with the page.
struct PlotStyle {
  std::string x_label;
  std::string y_label;
  double width = 1000.0;
  double height = 260.0;
  std::vector<std::pair<double, double>> shaded;  ///< intervals of x with a tinted background
  std::vector<double> markers;                    ///< vertical lines
};

/// A line plot as one <svg> element, without scripts and without outside resources. Lines of more than 1500 points are
/// thinned, keeping the smallest and largest value of every stretch.
std::string svgPlot(const std::vector<PlotLine>& lines, const PlotStyle& style);

/// Several plots, each as svgPlot writes it, below each other in one <svg> file with a title (a second line of it is
/// smaller).
std::string stackedSvg(const std::string& title, const std::vector<std::string>& plots, double width,
                       const std::vector<double>& heights);

/// Text with the characters that HTML reserves replaced.
std::string escapeHtml(const std::string& text);

}  // namespace knee_robot::report
