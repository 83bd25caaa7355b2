#include "monitor_scene.h"

#include <algorithm>
#include <cmath>

#include "controller_pose.h"
#include "knee_robot/base/constants.h"
#include "monitor_board.h"

namespace knee_robot::nodes {
namespace {

using visualization_msgs::Marker;

constexpr double kErrorScale_m = 0.005;  // whole length of an error's bar
constexpr double kErrorNear_m = 0.001, kErrorBad_m = 0.002;
constexpr double kMarginNear = 0.2, kMarginBad = 0.05;
constexpr Color kGhost{0.10F, 0.70F, 0.35F, 0.40F}, kGhostLine{0.10F, 0.60F, 0.30F, 0.9F},
    kPath{0.15F, 0.35F, 0.85F, 0.9F}, kPathEdge{0.15F, 0.35F, 0.85F, 0.45F};

/// Where a point of the platform is at this pose.
mechanism::Vector3 transformed(const mechanism::Pose& pose, const mechanism::Vector3& point) {
  return mechanism::Vector3(pose[0], 0.0, pose[1]) + mechanism::platformRotation(pose) * point;
}

/// A ring around the platform, its joints and its legs: wider than the robot's own, so that it is seen where both
/// coincide.
void addGhost(Scene& scene, const mechanism::Mechanism& mechanism, const mechanism::Pose& pose) {
  constexpr int corners = 48;
  constexpr double above = 0.032;  // m, over the drawn plate
  double radius = 0.0;
  for (const mechanism::Vector3& point : mechanism.platform_points)
    radius = std::max(radius, point.norm());
  Marker& ring = scene.add("reference", Marker::LINE_STRIP, kGhostLine);
  ring.scale.x = 0.010;
  for (int k = 0; k <= corners; ++k) {
    const double angle = kTwoPi * k / corners;
    ring.points.push_back(
        pointOf(transformed(pose, {(radius + 0.05) * std::cos(angle), (radius + 0.05) * std::sin(angle), 0.02})));
  }
  Marker& spokes = scene.add("reference", Marker::LINE_LIST, kGhostLine);
  spokes.scale.x = 0.008;
  Marker& legs = scene.add("reference", Marker::LINE_LIST, kGhost);
  legs.scale.x = 0.034;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const mechanism::Vector3 tip =
        i < 3 ? mechanism::Vector3(mechanism.platform_points[i]) : mechanism::Vector3::Zero();
    const mechanism::Vector3 up(0.0, 0.0, above);
    if (i < 3) {
      spokes.points.push_back(pointOf(transformed(pose, up)));
      spokes.points.push_back(pointOf(transformed(pose, 1.07 * tip + up)));
    }
    legs.points.push_back(pointOf(mechanism.base_points[i]));
    legs.points.push_back(pointOf(transformed(pose, tip)));
  }
}

/// While something is played, only what is still to come; the approach to a path is not that path yet.
void addPath(Scene& scene, const mechanism::Mechanism& mechanism, const Heard& heard) {
  double from = -1.0;
  if (heard.state && heard.state->playing == heard.state->reference_file) from = heard.state->path_time_s;
  for (const bool edge : {false, true}) {
    const mechanism::Vector3 shown =
        edge ? mechanism::Vector3(mechanism.platform_points[0]) : mechanism::Vector3::Zero();
    std::vector<geometry_msgs::Point> points;
    for (const geometry_msgs::PoseStamped& point : heard.path->poses) {
      if (point.header.stamp.toSec() >= from) points.push_back(pointOf(transformed(poseOf(point.pose), shown)));
    }
    if (points.size() < 2) continue;
    Marker& line = scene.add("path", Marker::LINE_STRIP, edge ? kPathEdge : kPath);
    line.scale.x = edge ? 0.004 : 0.008;
    line.points = std::move(points);
  }
}

void addErrors(Board& board, const Tracking& tracking) {
  board.title("errors", "tracking error (bar: 5 mm)");
  for (std::size_t i = 0; i < mechanism::kLegs; ++i) {
    const double error = tracking.error_m[i], size = std::abs(error);
    const Color& color = size < kErrorNear_m ? kGood : size < kErrorBad_m ? kNear : kBad;
    board.bar("errors", "leg " + std::to_string(i + 1), size / kErrorScale_m, fixedNumber(1e3 * error, 2) + " mm",
              color);
  }
  board.gap();
}

void addMargin(Board& board, const std::string& name, double left) {
  const Color& color = left > kMarginNear ? kGood : left > kMarginBad ? kNear : kBad;
  board.bar("margins", name, left, std::isfinite(left) ? fixedNumber(100.0 * left, 0) + " %" : "unknown", color);
}

void addMargins(Board& board, const Margins& margins) {
  board.title("margins", "left to the limit");
  if (std::isfinite(margins.condition_limit))
    addMargin(board, "singularity", 1.0 - margins.condition / margins.condition_limit);
  for (std::size_t i = 0; i < mechanism::kLegs; ++i)
    addMargin(board, (i < 3 ? "universal " : "revolute ") + std::to_string(i + 1),
              1.0 - margins.base_angle_rad[i] / margins.base_angle_limit_rad[i]);
  for (std::size_t i = 0; i < 3; ++i)
    addMargin(board, "spherical " + std::to_string(i + 1),
              1.0 - margins.platform_angle_rad[i] / margins.platform_angle_limit_rad[i]);
  for (std::size_t i = 0; i < mechanism::kLegs; ++i) {
    const double to_min = margins.length_m[i] - margins.length_min_m[i];
    const double to_max = margins.length_max_m[i] - margins.length_m[i];
    addMargin(board, "length " + std::to_string(i + 1),
              2.0 * std::min(to_min, to_max) / (margins.length_max_m[i] - margins.length_min_m[i]));
  }
}

/// The force that would explain the residual, at the platform: 100 N are 0.1 m. Within what the bands can look like
/// there is none.
void addResidual(Scene& scene, const Residual& residual) {
  constexpr double kMetresPerNewton = 0.001;
  const double force = std::hypot(residual.wrench[0], residual.wrench[1]);
  if (!residual.known || !residual.identified || force < std::hypot(residual.wrench_band[0], residual.wrench_band[1]))
    return;
  const bool said = !residual.warnings.empty() || !residual.errors.empty();
  const mechanism::Vector3 at(residual.pose[0], 0.0, residual.pose[1]);
  const mechanism::Vector3 way = kMetresPerNewton * mechanism::Vector3(residual.wrench[0], 0.0, residual.wrench[1]);
  Marker& arrow = scene.add("residual", Marker::ARROW, said ? kBad : kNear);
  arrow.points = {pointOf(at), pointOf(at + way)};
  arrow.scale.x = 0.015;  // shaft and head, m
  arrow.scale.y = 0.03;
  scene.text("residual", fixedNumber(force, 0) + " N", at + way, 0.03, kInk);
}

void addNotices(Scene& scene, const Residual& residual) {
  std::string words;
  for (const auto* all : {&residual.errors, &residual.warnings}) {
    for (const std::string& sentence : *all)
      words += (words.empty() ? "" : "\n") + wrapped(sentence, 70);
  }
  if (!words.empty()) scene.text("residual", words, {-0.05, 0.0, 1.08}, 0.03, residual.errors.empty() ? kNear : kBad);
}

std::string stateText(const ControllerState& state) {
  std::string words = state.state;
  if (!state.playing.empty())
    words += ": " + state.playing + ", " + fixedNumber(state.path_time_s, 1) + " of " +
             fixedNumber(state.duration_s, 1) + " s, speed " + fixedNumber(100.0 * state.time_scale, 0) + " %";
  if (state.recording) words += ", recording";
  return words;
}

void addText(Scene& scene, const Heard& heard) {
  const mechanism::Vector3 top(-0.05, 0.0, 1.16);
  if (heard.silent || !heard.state) {
    scene.text("text", "the controller is silent", top, 0.06, kBad);
  } else if (heard.state->fault.empty()) {
    scene.text("text", stateText(*heard.state), top, 0.045, kInk);
  } else {
    scene.text("text", "FAULT " + heard.state->fault + "\n" + wrapped(heard.state->cause, 70), top, 0.045, kBad);
  }
}

}  // namespace

visualization_msgs::MarkerArray sceneOf(const mechanism::Robot& robot, const Heard& heard) {
  visualization_msgs::MarkerArray array;
  Scene scene(array);
  addText(scene, heard);
  if (heard.residual && !heard.silent) {
    addResidual(scene, *heard.residual);
    addNotices(scene, *heard.residual);
  }
  if (robot.mechanism) {
    if (heard.reference) addGhost(scene, *robot.mechanism, *heard.reference);
    if (heard.path && !heard.path->poses.empty()) addPath(scene, *robot.mechanism, heard);
  }
  Board board(scene, mechanism::Vector3(-0.56, 0.0, 1.02));
  if (heard.tracking) addErrors(board, *heard.tracking);
  if (heard.margins) addMargins(board, *heard.margins);
  return array;
}

}  // namespace knee_robot::nodes
