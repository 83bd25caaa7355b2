#pragma once

#include <string>
#include <utility>
#include <vector>

#include "knee_robot/report/compare.h"
#include "knee_robot/report/json_parts.h"

namespace knee_robot::report {

/// One plot of a comparison, as svgPlot writes it.
struct ComparePanel {
  std::string title;  ///< "Leg 2", "psi"
  std::string svg;
  double height = 0.0;
};

/// Reference and measured length, and their difference, of every actuator (Fig. 15).
std::vector<ComparePanel> actuatorPanels(const CompareResults& results);
/// Reference, encoders and camera in pose, and the differences (Fig. 16). Needs a pose.
std::vector<ComparePanel> posePanels(const CompareResults& results);
/// Stretches of time near a singularity.
std::vector<std::pair<double, double>> singularStretches(const CompareResults& results);
/// What the plots of compare's page show beside report.json: the same curves, m and rad.
Json compareSeries(const CompareResults& results);
/// What a coordinate of the pose (X, Z, theta, psi) in m or rad is multiplied with to be shown: mm, degrees.
double unitOf(int coordinate);
/// Panels as one picture.
std::string panelsSvg(const std::string& title, const std::vector<ComparePanel>& panels);

}  // namespace knee_robot::report
