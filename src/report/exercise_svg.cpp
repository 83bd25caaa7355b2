#include <algorithm>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/exercise_report.h"
#include "svg_plot.h"

namespace knee_robot::report {
namespace {

constexpr double kWidth = 1000.0, kPanel = 190.0;
constexpr const char* kColours[4] = {"#1b6ca8", "#d1495b", "#2e8b57", "#9a6bb0"};

std::vector<double> times(Eigen::Index points) {
  std::vector<double> out;
  for (Eigen::Index k = 0; k < points; ++k)
    out.push_back(trajectory::kStreamPeriod * static_cast<double>(k));
  return out;
}

PlotLine line(const std::string& label, int colour, const std::vector<double>& t, const Eigen::VectorXd& values) {
  return {label, kColours[colour], t, {values.data(), values.data() + values.size()}};
}

/// Share of each kind of limit that is left at one pose; 1 far away, 0 at the limit.
struct Left {
  double length = 1.0, base_angle = 1.0, platform_angle = 1.0, condition = 1.0;
  double least() const { return std::min({length, base_angle, platform_angle, condition}); }
};

Left leftAt(const mechanism::Robot& robot, const mechanism::Pose& pose, const mechanism::Lengths& lengths,
            double condition_max) {
  Left left;
  const mechanism::JointAngles angles = mechanism::jointAngles(*robot.mechanism, pose);
  for (std::size_t i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::Actuator& a = robot.actuators[i];
    const double half = 0.5 * (a.position_max_m - a.position_min_m), q = lengths[static_cast<Eigen::Index>(i)];
    left.length = std::min({left.length, (q - a.position_min_m) / half, (a.position_max_m - q) / half});
    left.base_angle = std::min(left.base_angle,
                               1.0 - angles.base[i] / (i < 3 ? robot.joints.universal_max : robot.joints.revolute_max));
    if (i < 3)
      left.platform_angle = std::min(left.platform_angle, 1.0 - angles.platform[i] / robot.joints.spherical_max);
  }
  left.condition = 1.0 - mechanism::conditionNumber(*robot.mechanism, pose) / condition_max;
  return left;
}

/// Percent left of each kind of limit against time, and where it is least.
std::vector<PlotLine> marginLines(const mechanism::Robot& robot, const trajectory::ExercisePlan& plan,
                                  const std::vector<double>& t, Eigen::Index& tightest) {
  const double condition_max = trajectory::planningCondition(robot);
  std::vector<PlotLine> lines = {{"lengths", kColours[0], t, {}},
                                 {"base joints", kColours[1], t, {}},
                                 {"spherical joints", kColours[2], t, {}},
                                 {"singularity margin", kColours[3], t, {}}};
  double least = 2.0;
  tightest = 0;
  for (Eigen::Index k = 0; k < plan.check.poses.rows(); ++k) {
    const Left left =
        leftAt(robot, plan.check.poses.row(k).transpose(), plan.check.lengths.row(k).transpose(), condition_max);
    const double values[] = {left.length, left.base_angle, left.platform_angle, left.condition};
    for (std::size_t n = 0; n < 4; ++n)
      lines[n].y.push_back(100.0 * values[n]);
    if (left.least() >= least) continue;
    least = left.least();
    tightest = k;
  }
  return lines;
}

}  // namespace

std::string exerciseSvg(const trajectory::Exercise& exercise, const mechanism::Robot& robot,
                        const trajectory::ExercisePlan& plan) {
  const trajectory::Points &poses = plan.check.poses, &lengths = plan.check.lengths;
  const std::vector<double> t = times(poses.rows());
  Eigen::Index tightest = 0;
  const std::vector<PlotLine> margins = marginLines(robot, plan, t, tightest);
  PlotStyle style;
  style.width = kWidth;
  style.height = kPanel;
  style.x_label = "time, s";
  style.markers = {t[static_cast<std::size_t>(tightest)]};
  std::vector<std::string> plots;
  const auto add = [&](const std::string& label, const std::vector<PlotLine>& lines) {
    style.y_label = label;
    plots.push_back(svgPlot(lines, style));
  };
  add("Xm, mm", {line("Xm", 0, t, 1e3 * poses.col(0))});
  add("Zm, mm", {line("Zm", 1, t, 1e3 * poses.col(1))});
  add("turn, deg", {line("theta", 2, t, kDegrees * poses.col(2)), line("psi", 3, t, kDegrees * poses.col(3))});
  std::vector<PlotLine> length_lines, velocity_lines;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const std::string name = "leg " + std::to_string(i + 1);
    length_lines.push_back(line(name, i, t, 1e3 * lengths.col(i)));
    Eigen::VectorXd velocity = Eigen::VectorXd::Zero(lengths.rows());
    for (Eigen::Index k = 1; k < lengths.rows(); ++k)
      velocity[k] = 1e3 * (lengths(k, i) - lengths(k - 1, i)) / trajectory::kStreamPeriod;
    velocity_lines.push_back(line(name, i, t, velocity));
  }
  add("length, mm", length_lines);
  add("velocity, mm/s", velocity_lines);
  add("left of the limit, %", margins);
  const trajectory::Margin nearest =
      trajectory::nearestLimit(robot, poses.row(tightest).transpose(), trajectory::planningCondition(robot));
  const std::string title = exercise.name + ": " + exercise.meaning +
                            "\nNearest limit: " + trajectory::limitText(nearest) + " at " +
                            shortNumber(t[static_cast<std::size_t>(tightest)], 4) + " s, " +
                            shortNumber(100.0 * nearest.left, 3) + " % left; dashed. Robot " + robot.path;
  return stackedSvg(title, plots, kWidth, std::vector<double>(plots.size(), kPanel));
}

}  // namespace knee_robot::report
