#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/simulation/camera.h"

namespace knee_robot::simulation {
namespace {

std::array<double, 4> perLeg(const std::vector<double>& values) {
  return {values[0], values[1], values[2], values[3]};
}

std::string cells(const Eigen::MatrixXd& mocap, Eigen::Index row) {
  std::string out;
  for (Eigen::Index k = 0; k < mocap.cols(); ++k) {
    char cell[32];
    std::snprintf(cell, sizeof cell, ",%.9g", mocap(row, k));
    out += std::isfinite(mocap(row, k)) ? cell : ",nan";
  }
  return out;
}

}  // namespace

CameraSimulation loadCameraSimulation(const std::string& path) {
  StrictMap file = StrictMap::load(path);
  CameraSimulation c;
  c.period_s = file.numberOr("period_s", c.period_s, 1e-3, 10.0);
  c.delay_s = file.numberOr("delay_s", c.delay_s, 0.0, 10.0);
  c.noise_m = file.numberOr("noise_m", c.noise_m, 0.0, 0.1);
  c.noise_rad = file.numberOr("noise_rad", c.noise_rad, 0.0, 1.0);
  c.missing_share = file.numberOr("missing_share", c.missing_share, 0.0, 1.0);
  c.rotation_rad = file.numberOr("rotation_rad", c.rotation_rad, -4.0, 4.0);
  c.shift_x_m = file.numberOr("shift_x_m", c.shift_x_m, -10.0, 10.0);
  c.shift_z_m = file.numberOr("shift_z_m", c.shift_z_m, -10.0, 10.0);
  c.plate_rad = file.numberOr("plate_rad", c.plate_rad, -4.0, 4.0);
  if (file.has("home_offset_m")) c.home_offset_m = perLeg(file.numbers("home_offset_m", 4, -0.1, 0.1));
  if (file.has("half_play_m")) c.half_play_m = perLeg(file.numbers("half_play_m", 4, -0.01, 0.01));
  c.play_width_m = file.numberOr("play_width_m", c.play_width_m, 1e-6, 0.01);
  c.seed = static_cast<unsigned>(file.integerOr("seed", static_cast<int>(c.seed), 0, 1 << 30));
  file.finish();
  return c;
}

std::string withCameraColumns(const std::string& content, const recording::Recording& r) {
  std::istringstream lines(content);
  std::string out, line;
  Eigen::Index row = -1;  // the header
  while (row < r.mocap.rows() && std::getline(lines, line)) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (row < 0) {
      if (line.find("mocap_") != std::string::npos)
        throw InputError(r.path + ":1: has camera columns already; give a recording without");
      line += ",mocap_x_m,mocap_z_m,mocap_theta_rad,mocap_psi_rad";
    } else {
      line += cells(r.mocap, row);
    }
    out += line + '\n';
    ++row;
  }
  return out;
}

}  // namespace knee_robot::simulation
