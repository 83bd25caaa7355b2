#include "compare_panels.h"

#include "knee_robot/base/constants.h"
#include "svg_plot.h"

namespace knee_robot::report {
namespace {

constexpr const char* kReference = "#555555";
constexpr const char* kMeasured = "#1b6ca8";
constexpr const char* kCamera = "#d1495b";
constexpr double kPerMetre = 1e3;

const char* const kCoordinates[4] = {"X", "Z", "theta", "psi"};
const char* const kAxes[4] = {"X, mm", "Z, mm", "theta (about Y), deg", "psi (about Z), deg"};

std::vector<double> scaled(const Eigen::MatrixXd& m, int column, double factor) {
  const Eigen::VectorXd values = factor * m.col(column);
  return {values.data(), values.data() + values.size()};
}

}  // namespace

double unitOf(int coordinate) {
  return coordinate < 2 ? kPerMetre : kDegrees;
}

std::vector<ComparePanel> actuatorPanels(const CompareResults& r) {
  std::vector<ComparePanel> out;
  const std::vector<double>& t = r.recording.time_s;
  const Eigen::MatrixXd error = r.recording.position_m - r.recording.reference_m;
  PlotStyle style;
  style.x_label = "time, s";
  for (int i = 0; i < r.recording.axes; ++i) {
    const std::string title = (r.has_pose ? "Leg " : "Axis ") + std::to_string(i + 1);
    style.height = 230.0;
    style.y_label = title + ", length, mm";
    out.push_back({title,
                   svgPlot({{"reference", kReference, t, scaled(r.recording.reference_m, i, kPerMetre)},
                            {"measured", kMeasured, t, scaled(r.recording.position_m, i, kPerMetre)}},
                           style),
                   style.height});
    style.height = 150.0;
    style.y_label = "error, mm";
    out.push_back({title, svgPlot({{"measured minus reference", kMeasured, t, scaled(error, i, kPerMetre)}}, style),
                   style.height});
  }
  return out;
}

/// Stretches of time near a singularity.
std::vector<std::pair<double, double>> singularStretches(const CompareResults& r) {
  std::vector<std::pair<double, double>> out;
  bool inside = false;
  for (int i = 0; i < r.recording.rows(); ++i) {
    const bool near = r.measured.condition[i] >= r.condition_max;
    const double t = r.recording.time_s[static_cast<std::size_t>(i)];
    if (near && !inside) out.emplace_back(t, t);
    if (near) out.back().second = t;
    inside = near;
  }
  return out;
}

std::vector<ComparePanel> posePanels(const CompareResults& r) {
  std::vector<ComparePanel> out;
  const std::vector<double>& t = r.recording.time_s;
  const Eigen::MatrixXd error = r.measured.pose - r.reference.pose;
  PlotStyle style;
  style.x_label = "time, s";
  style.shaded = singularStretches(r);
  for (int k = 0; k < 4; ++k) {
    const double unit = unitOf(k);
    std::vector<PlotLine> lines = {{"reference", kReference, t, scaled(r.reference.pose, k, unit)},
                                   {"encoders", kMeasured, t, scaled(r.measured.pose, k, unit)}};
    std::vector<PlotLine> errors = {{"encoders minus reference", kMeasured, t, scaled(error, k, unit)}};
    if (r.has_camera) {
      lines.push_back({"camera", kCamera, t, scaled(r.camera.pose, k, unit)});
      errors.push_back({"camera minus encoders", kCamera, t, scaled(r.camera.pose - r.measured.pose, k, unit)});
    }
    style.height = 230.0;
    style.y_label = kAxes[k];
    out.push_back({kCoordinates[k], svgPlot(lines, style), style.height});
    style.height = 150.0;
    style.y_label = std::string("error, ") + kPaperFigures[4 + k].unit;
    out.push_back({kCoordinates[k], svgPlot(errors, style), style.height});
  }
  return out;
}

std::string panelsSvg(const std::string& title, const std::vector<ComparePanel>& panels) {
  std::vector<std::string> plots;
  std::vector<double> heights;
  for (const ComparePanel& panel : panels) {
    plots.push_back(panel.svg);
    heights.push_back(panel.height);
  }
  return stackedSvg(title, plots, PlotStyle().width, heights);
}

}  // namespace knee_robot::report
