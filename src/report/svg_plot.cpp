#include "svg_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "knee_robot/base/numbers.h"

namespace knee_robot::report {
namespace {

constexpr double kLeft = 64.0, kRight = 12.0, kTop = 22.0, kBottom = 40.0;
constexpr std::size_t kMostSvgPoints = 1500;
constexpr double kFlatRange =
    1e-9;  ///< a range that is smaller beside its values is rounding, which ticks could not count along

std::string fixed(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

/// From data to drawing.
struct Frame {
  double x0 = 0.0, x1 = 1.0, y0 = 0.0, y1 = 1.0;
  double width = 0.0, height = 0.0;

  double px(double x) const { return kLeft + (x - x0) / (x1 - x0) * (width - kLeft - kRight); }
  double py(double y) const { return height - kBottom - (y - y0) / (y1 - y0) * (height - kTop - kBottom); }
  bool shows(double x, double y) const { return std::isfinite(x) && std::isfinite(y); }
};

void widen(double& low, double& high, double share) {
  if (!(low <= high)) {
    low = 0.0;
    high = 1.0;
  }
  const bool flat = high - low <= kFlatRange * std::max(std::abs(low), std::abs(high));
  const double margin = flat ? 0.1 * std::abs(high) + 0.1 : share * (high - low);
  low -= margin;
  high += margin;
}

Frame frameOf(const std::vector<PlotLine>& lines, const PlotStyle& style) {
  Frame f;
  f.width = style.width;
  f.height = style.height;
  f.x0 = f.y0 = std::numeric_limits<double>::infinity();
  f.x1 = f.y1 = -f.x0;
  for (const PlotLine& line : lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!f.shows(line.x[i], line.y[i])) continue;
      f.x0 = std::min(f.x0, line.x[i]);
      f.x1 = std::max(f.x1, line.x[i]);
      f.y0 = std::min(f.y0, line.y[i]);
      f.y1 = std::max(f.y1, line.y[i]);
    }
  }
  widen(f.x0, f.x1, 0.0);
  widen(f.y0, f.y1, 0.05);
  return f;
}

/// Distance of ticks: 1, 2 or 5 times a power of ten, about `count` of them.
double tickStep(double span, int count) {
  const double raw = span / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

std::vector<double> linearTicks(double low, double high, int count) {
  std::vector<double> ticks;
  const double step = tickStep(high - low, count);
  const double first = std::ceil(low / step);
  for (int k = 0; k <= 10 * count && (first + k) * step <= high + 1e-9 * step; ++k)
    ticks.push_back((first + k) * step);
  return ticks;
}

std::string text(double x, double y, const char* style, const std::string& content) {
  return "<text x=\"" + fixed(x) + "\" y=\"" + fixed(y) + "\" " + style + ">" + escapeHtml(content) + "</text>\n";
}

std::string drawAxes(const Frame& f, const PlotStyle& style) {
  const double right = f.width - kRight, bottom = f.height - kBottom;
  std::string out;
  for (const double y : linearTicks(f.y0, f.y1, 5)) {
    const std::string at = fixed(f.py(y));
    out += "<path class=\"grid\" d=\"M" + fixed(kLeft) + " " + at + "H" + fixed(right) + "\"/>\n";
    out += text(kLeft - 6, f.py(y) + 4, "text-anchor=\"end\"", shortNumber(std::abs(y) < 1e-12 ? 0.0 : y));
  }
  for (const double x : linearTicks(f.x0, f.x1, 10)) {
    const std::string at = fixed(f.px(x));
    out += "<path class=\"grid\" d=\"M" + at + " " + fixed(kTop) + "V" + fixed(bottom) + "\"/>\n";
    out += text(f.px(x), bottom + 15, "text-anchor=\"middle\"", shortNumber(std::abs(x) < 1e-12 ? 0.0 : x));
  }
  out += "<rect class=\"frame\" x=\"" + fixed(kLeft) + "\" y=\"" + fixed(kTop) + "\" width=\"" + fixed(right - kLeft) +
         "\" height=\"" + fixed(bottom - kTop) + "\"/>\n";
  out += text((kLeft + right) / 2, f.height - 8, "text-anchor=\"middle\"", style.x_label);
  const double middle = (kTop + bottom) / 2;
  const std::string turned = "text-anchor=\"middle\" transform=\"rotate(-90 14 " + fixed(middle) + ")\"";
  return out + text(14, middle, turned.c_str(), style.y_label);
}

std::string drawShades(const Frame& f, const PlotStyle& style) {
  std::string out;
  for (const auto& [from, to] : style.shaded) {
    const double a = f.px(std::clamp(from, f.x0, f.x1)), b = f.px(std::clamp(to, f.x0, f.x1));
    if (b <= a) continue;
    out += "<rect class=\"shade\" x=\"" + fixed(a) + "\" y=\"" + fixed(kTop) + "\" width=\"" + fixed(b - a) +
           "\" height=\"" + fixed(f.height - kTop - kBottom) + "\"/>\n";
  }
  for (const double x : style.markers) {
    out += "<path class=\"marker\" d=\"M" + fixed(f.px(x)) + " " + fixed(kTop) + "V" + fixed(f.height - kBottom) +
           "\"/>\n";
  }
  return out;
}

/// Indices to draw: all, or the smallest and largest of every stretch.
std::vector<std::size_t> thin(const PlotLine& line) {
  std::vector<std::size_t> keep;
  const std::size_t n = line.x.size();
  const std::size_t stretch = n <= kMostSvgPoints ? 1 : 2 * n / kMostSvgPoints + 1;
  for (std::size_t at = 0; at < n; at += stretch) {
    std::size_t low = at, high = at;
    for (std::size_t i = at; i < std::min(n, at + stretch); ++i) {
      if (line.y[i] < line.y[low]) low = i;
      if (line.y[i] > line.y[high]) high = i;
    }
    keep.push_back(std::min(low, high));
    if (low != high) keep.push_back(std::max(low, high));
  }
  return keep;
}

std::string drawLine(const Frame& f, const PlotLine& line) {
  std::string path;
  bool pen_down = false;
  for (const std::size_t i : thin(line)) {
    if (!f.shows(line.x[i], line.y[i])) {
      pen_down = false;
      continue;
    }
    path += (pen_down ? "L" : "M") + fixed(f.px(line.x[i])) + " " + fixed(f.py(line.y[i]));
    pen_down = true;
  }
  return "<path class=\"line\" stroke=\"" + line.color + "\" d=\"" + path + "\"/>\n";
}

std::string drawLegend(const Frame& f, const std::vector<PlotLine>& lines) {
  std::string out;
  double x = f.width - kRight;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    x -= 7.0 * static_cast<double>(line->label.size()) + 44.0;
    out += "<path class=\"line\" stroke=\"" + line->color + "\" stroke-width=\"3\" d=\"M" + fixed(x) + " 11h18\"/>\n";
    out += text(x + 23, 15, "", line->label);
  }
  return out;
}

}  // namespace

std::string escapeHtml(const std::string& raw) {
  std::string out;
  for (const char c : raw) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string svgPlot(const std::vector<PlotLine>& lines, const PlotStyle& style) {
  const Frame f = frameOf(lines, style);
  std::string out = "<svg viewBox=\"0 0 " + fixed(f.width) + " " + fixed(f.height) + "\" role=\"img\" aria-label=\"" +
                    escapeHtml(style.y_label + " over " + style.x_label) + "\">\n";
  out += drawShades(f, style) + drawAxes(f, style);
  for (const PlotLine& line : lines)
    out += drawLine(f, line);
  return out + drawLegend(f, lines) + "</svg>\n";
}

}  // namespace knee_robot::report
