#include "knee_robot/tracing/pose_trace.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/quantile.h"
#include "pose_search.h"

namespace knee_robot::tracing {
namespace {

constexpr double kPickRate_hz = 25.0;

/// Standard deviation of single pictures: second differences of neighbours, robustly (1.4826 times the median
/// magnitude), over sqrt(6).
mechanism::Vector4 pictureNoise(const std::vector<PoseView>& views) {
  std::vector<double> second[4];
  for (const PoseView& view : views) {
    std::vector<Eigen::Index> pictures;
    const Eigen::MatrixXd& m = view.recording->mocap;
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      if (m.row(i).allFinite()) pictures.push_back(i);
    }
    for (std::size_t n = 1; n + 1 < pictures.size(); ++n) {
      for (int k = 0; k < 4; ++k)
        second[k].push_back(std::abs(m(pictures[n - 1], k) - 2.0 * m(pictures[n], k) + m(pictures[n + 1], k)));
    }
  }
  mechanism::Vector4 noise = mechanism::Vector4::Zero();
  for (int k = 0; k < 4; ++k) {
    if (second[k].empty()) continue;
    noise[k] = 1.4826 * median(std::move(second[k])) / std::sqrt(6.0);
  }
  return noise;
}

PoseErrors errorsOf(const Eigen::MatrixXd& error, const std::vector<Eigen::Index>& rows) {
  PoseErrors e;
  for (const Eigen::Index row : rows) {
    if (!error.row(row).allFinite()) continue;
    ++e.rows;
    e.rms += error.row(row).transpose().cwiseAbs2();
    e.max = e.max.cwiseMax(error.row(row).transpose().cwiseAbs());
  }
  if (e.rows > 0) e.rms = (e.rms / e.rows).cwiseSqrt();
  return e;
}

/// Camera in the robot's frame minus the model's pose.
Eigen::MatrixXd errorOf(const mechanism::Robot& robot, const PoseView& view, const PoseModel& model) {
  Eigen::MatrixXd error = -modelPoses(robot, model, *view.recording, view.measured);
  for (Eigen::Index n = 0; n < error.rows(); ++n)
    error.row(n) += cameraInRobot(model.frame, view.camera.row(n).transpose()).transpose();
  return error;
}

/// The model as other recordings have it.
PoseModel transferred(const PoseTrace& trace) {
  PoseModel model = trace.model;
  for (std::size_t k = 0; k < trace.findings.size(); ++k) {
    if (!trace.findings[k].transfers) model.values[static_cast<Eigen::Index>(k)] = 0.0;
  }
  return model;
}

/// `model`: as this recording has it.
PoseRecording evaluatePose(const mechanism::Robot& robot, const PoseView& view, const PoseTrace& trace,
                           const PoseModel& model, const mechanism::Vector4& sigma) {
  PoseRecording out;
  out.path = view.recording->path;
  out.name = view.recording->name;
  out.time_s = view.recording->time_s;
  out.own = view.own;
  out.other_solution = view.other_solution;
  out.near_singular = view.near_singular;
  out.distrusted = view.distrusted;
  PoseModel nothing;
  nothing.frame = trace.before;
  nothing.values.resize(0);
  out.before_error = errorOf(robot, view, nothing);
  out.after_error = errorOf(robot, view, model);
  out.before = errorsOf(out.before_error, view.rows);
  out.after = errorsOf(out.after_error, view.rows);
  if (view.rows.empty()) return out;
  // What is left when only frame and delay are this recording's own: dimensions and offsets stay training's.
  std::vector<PoseView> own = {view};
  setDelay(own.front(), view.own.delay_s);
  mechanism::Robot changed = robot;
  changed.mechanism = changedMechanism(*robot.mechanism, model);
  recording::Recording moved = *view.recording;
  moved.position_m = changedLengths(view, model);
  own.front().recording = &moved;
  PoseModel frame;
  frame.frame = model.frame;
  frame.values.resize(0);
  fitPose(changed, own, stackPose(own, kPickRate_hz), sigma, {}, frame);
  Eigen::MatrixXd error(view.camera.rows(), 4);
  const Eigen::MatrixXd poses = modelPoses(robot, model, *view.recording, view.measured);
  for (Eigen::Index n = 0; n < error.rows(); ++n)
    error.row(n) = cameraInRobot(frame.frame, own.front().camera.row(n).transpose()).transpose() - poses.row(n);
  out.refitted = errorsOf(error, view.rows);
  return out;
}

/// One delay for all: the mean of those that are known.
double commonDelay(std::vector<PoseView>& views, PoseTrace& trace) {
  double sum = 0.0, least = 1e9, most = -1e9;
  int known = 0;
  for (const PoseView& view : views) {
    if (!view.own.delay_known) continue;
    ++known;
    sum += view.own.delay_s;
    least = std::min(least, view.own.delay_s);
    most = std::max(most, view.own.delay_s);
  }
  if (known == 0) {
    trace.notes.push_back("The camera's delay could not be determined; none was assumed.");
    return 0.0;
  }
  trace.notes.push_back("Camera " + shortNumber(1e3 * sum / known, 3) + " ms late (cross-correlation of velocities" +
                        (known > 1 ? "; " + shortNumber(1e3 * least, 3) + " to " + shortNumber(1e3 * most, 3) +
                                         " ms between training recordings"
                                   : std::string()) +
                        ").");
  for (PoseView& view : views)
    setDelay(view, sum / known);
  return sum / known;
}

void noteMask(const PoseView& view, std::vector<std::string>& notes) {
  notes.push_back(view.recording->name + ": " + std::to_string(view.rows.size()) + " rows compared; left out " +
                  std::to_string(view.near_singular) + " near a singularity, " + std::to_string(view.other_solution) +
                  " on the other solution of the same lengths, " + std::to_string(view.distrusted) +
                  " with a picture far from everything.");
}

/// Frames of one camera that differ between recordings: nothing fixed can be fitted to both.
void noteMovedCamera(const std::vector<PoseView>& views, std::vector<std::string>& notes) {
  for (std::size_t k = 1; k < views.size(); ++k) {
    const CameraAlignment &a = views[0].own, &b = views[k].own;
    const double turn = kDegrees * std::abs(a.rotation_rad - b.rotation_rad),
                 plate = kDegrees * std::abs(a.plate_rad - b.plate_rad);
    const double shift = 1e3 * std::hypot(a.shift_x_m - b.shift_x_m, a.shift_z_m - b.shift_z_m);
    if (turn < 0.2 && plate < 0.5 && shift < 3.0) continue;
    notes.push_back("Between " + views[0].recording->name + " and " + views[k].recording->name +
                    " the camera's own frame differs by " + shortNumber(turn, 2) + " deg about Y, " +
                    shortNumber(shift, 2) + " mm, and " + shortNumber(plate, 2) +
                    " deg of the markers: the camera or the markers may have been moved, or something depends on the "
                    "pose.");
  }
}

}  // namespace

const char* nameOf(PoseCause cause) {
  switch (cause) {
    case PoseCause::HomeOffset:
      return "home_offset";
    case PoseCause::GeometryError:
      return "geometry_error";
    case PoseCause::TravelClearance:
    case PoseCause::LoadClearance:
      break;
  }
  return "joint_clearance";
}

const std::vector<std::string>& poseDimensions() {
  static const std::vector<std::string> names = {"R_1_m",       "R_2_m",       "R_3_m",      "ds_m",
                                                 "beta_FD_rad", "beta_FI_rad", "Rm_1_m",     "Rm_2_m",
                                                 "Rm_3_m",      "beta_MD_rad", "beta_MI_rad"};
  return names;
}

std::string textOf(const PoseHypothesis& h) {
  const std::string leg = "leg " + std::to_string(h.index + 1);
  switch (h.cause) {
    case PoseCause::HomeOffset:
      return "home_offset of " + leg;
    case PoseCause::GeometryError:
      return "geometry_error in " + poseDimensions()[static_cast<std::size_t>(h.index)];
    case PoseCause::TravelClearance:
      return "joint_clearance of " + leg + " (direction of travel)";
    case PoseCause::LoadClearance:
      break;
  }
  return "joint_clearance of " + leg + " (direction of load)";
}

std::string parameterOf(const PoseHypothesis& h) {
  const std::string leg = std::to_string(h.index + 1) + "_m";
  if (h.cause == PoseCause::HomeOffset) return "length_" + leg;
  if (h.cause == PoseCause::GeometryError) return poseDimensions()[static_cast<std::size_t>(h.index)];
  return "half_play_" + leg;
}

PoseTrace tracePose(const mechanism::Robot& robot, const std::vector<recording::Recording>& train,
                    const std::vector<recording::Recording>& validate, const PoseTraceOptions& options) {
  PoseTrace trace;
  trace.condition_max = options.condition_max;
  if (!robot.mechanism) {
    trace.reason = "independent axes have no pose";
    return trace;
  }
  std::vector<PoseView> views;
  for (const recording::Recording& r : train) {
    PoseView view = viewPose(robot, r, options.condition_max, kNan);
    if (!view.rows.empty()) views.push_back(std::move(view));
  }
  if (views.empty()) {
    trace.reason = "no training recording has enough camera poses";
    return trace;
  }
  options.progress("pose: " + std::to_string(views.size()) + " training recording(s) with camera");
  trace.available = true;
  const double delay_s = commonDelay(views, trace);
  trace.noise = pictureNoise(views);
  noteMovedCamera(views, trace.notes);

  PoseSearch s;
  s.robot = &robot;
  s.views = &views;
  s.options = &options;
  s.stack = stackPose(views, kPickRate_hz);
  s.rate_hz = kPickRate_hz;
  s.hypotheses = poseHypotheses(views);
  s.model.frame = views.front().own;
  s.model.frame.delay_s = delay_s;
  startPoseSearch(s);
  trace.before = s.model.frame;
  searchPose(s);
  trace.model = s.model;
  trace.findings = s.findings;
  for (PoseFinding& f : trace.findings)
    f.transfers = f.hypothesis.cause != PoseCause::HomeOffset || views.size() > 1;
  trace.rejected = s.rejected;
  trace.absorbed = s.absorbed;
  if (views.size() == 1)
    trace.notes.push_back("One training recording with a camera: held-back pieces are contiguous parts of it.");

  for (const PoseView& view : views) {
    noteMask(view, trace.notes);
    trace.train.push_back(evaluatePose(robot, view, trace, trace.model, s.sigma));
  }
  for (const recording::Recording& r : validate) {
    const PoseView view = viewPose(robot, r, options.condition_max, delay_s);
    if (view.rows.empty()) continue;
    noteMask(view, trace.notes);
    trace.validate.push_back(evaluatePose(robot, view, trace, transferred(trace), s.sigma));
  }
  return trace;
}

}  // namespace knee_robot::tracing
