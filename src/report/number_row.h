#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <string>

namespace knee_robot::report {

/// A line of a terminal table: a name, then a figure per actuator with two decimals; "-" for what is not a number.
inline std::string numberRow(const std::string& name, const Eigen::VectorXd& values) {
  char text[64];
  std::snprintf(text, sizeof text, "  %-34s", name.c_str());
  std::string line = text;
  for (const double value : values) {
    std::snprintf(text, sizeof text, std::isfinite(value) ? "%9.2f" : "        -", value);
    line += text;
  }
  return line + "\n";
}

}  // namespace knee_robot::report
