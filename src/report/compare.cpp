#include "knee_robot/report/compare.h"

#include <cmath>
#include <limits>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::report {

const PaperFigure kPaperFigures[8] = {
    {"leg 1", "mm", "below 1"}, {"leg 2", "mm", "below 1"}, {"leg 3", "mm", "below 1"}, {"leg 4", "mm", "above 2"},
    {"X", "mm", "30"},          {"Z", "mm", "10"},          {"theta", "deg", "2.5"},    {"psi", "deg", "7"}};

ErrorFigures errorFigures(const std::vector<double>& time_s, const Eigen::VectorXd& error) {
  ErrorFigures f;
  double squares = 0.0, sum = 0.0;
  for (Eigen::Index i = 0; i < error.size(); ++i) {
    if (!std::isfinite(error[i])) continue;
    ++f.rows;
    sum += error[i];
    squares += error[i] * error[i];
    if (f.rows == 1 || std::abs(error[i]) > f.max_abs) {
      f.max_abs = std::abs(error[i]);
      f.time_of_max_s = time_s[static_cast<std::size_t>(i)];
    }
  }
  if (f.rows == 0) {
    f.max_abs = f.rms = f.mean = f.time_of_max_s = std::numeric_limits<double>::quiet_NaN();
    return f;
  }
  f.mean = sum / f.rows;
  f.rms = std::sqrt(squares / f.rows);
  return f;
}

namespace {

void comparePoses(const mechanism::Robot& robot, bool has_reference, CompareResults& r) {
  r.has_pose = true;
  r.measured = tracing::posesOf(*robot.mechanism, r.recording.position_m);
  r.reference = tracing::posesOf(*robot.mechanism, r.recording.reference_m);
  const int rows = r.recording.rows();
  if (r.measured.unknown == rows || (has_reference && r.reference.unknown == rows)) {
    throw Refusal(r.recording.path + ": forward kinematics finds no pose for the " +
                  (r.measured.unknown == rows ? "measured" : "reference") +
                  " lengths of any row; is this the robot file of the machine that was recorded?");
  }
  for (const auto& [path, name] : {std::pair{&r.measured, "measured"}, std::pair{&r.reference, "reference"}}) {
    if (path->unknown > 0 && (has_reference || path == &r.measured)) {
      r.notes.push_back("Forward kinematics found no pose for the " + std::string(name) + " lengths of " +
                        std::to_string(path->unknown) + " of " + std::to_string(rows) + " rows; they are left out.");
    }
  }
  const Eigen::MatrixXd error = r.measured.pose - r.reference.pose;
  for (int k = 0; k < 4; ++k)
    r.pose[k] = errorFigures(r.recording.time_s, error.col(k));
  const auto near = (r.measured.condition.array() >= r.condition_max).count();
  if (near == 0) return;
  r.notes.push_back("The condition of the Jacobian (m, rad) is above " + shortNumber(r.condition_max) + " in " +
                    std::to_string(near) + " of " + std::to_string(rows) +
                    " rows: there small errors of length are large errors of pose.");
}

void addCamera(const mechanism::Robot& robot, CompareResults& r) {
  r.has_camera = r.recording.mocap.cols() == 4;
  if (!r.has_camera) return;
  r.camera = compareCamera(*robot.mechanism, r.recording, r.measured, r.reference.pose, r.condition_max);
  if (!r.camera.alignment.known) {
    r.notes.push_back("The camera columns hold too few poses (fewer than 20 beside known ones) to compare with.");
    r.has_camera = false;
    return;
  }
  if (!r.camera.alignment.delay_known) {
    r.notes.push_back("The camera's delay could not be determined (correlation " +
                      shortNumber(r.camera.alignment.correlation, 3) + "); none was assumed.");
  }
  if (r.camera.other_solution > 0) {
    r.notes.push_back(
        "In " + std::to_string(r.camera.other_solution) + " rows between " + shortNumber(r.camera.other_from_s, 4) +
        " and " + shortNumber(r.camera.other_to_s, 4) +
        " s the measured lengths have a second pose that is nearer to the camera's: the platform was on the other "
        "side of a singularity, which encoders cannot see.");
  }
}

}  // namespace

CompareResults compare(const mechanism::Robot& robot, const recording::Recording& recording, double condition_max) {
  recording::requireAxes(recording, robot.axes(), robot.path);
  const bool has_reference = recording.reference_m.cols() > 0;
  if (!has_reference && (recording.mocap.cols() == 0 || !robot.mechanism)) {
    throw InputError(recording.path +
                     ":1: column reference_1_m is missing; without a reference, and without camera columns, there is "
                     "nothing to compare with");
  }
  CompareResults r;
  r.robot_path = robot.path;
  r.recording = recording;
  r.condition_max = condition_max;
  r.notes = recording.notes;
  if (!has_reference) {
    r.recording.reference_m =
        Eigen::MatrixXd::Constant(recording.rows(), recording.axes, std::numeric_limits<double>::quiet_NaN());
    r.notes.push_back("The recording has no reference: only camera and encoders are compared.");
  }
  const Eigen::MatrixXd error = recording.position_m - r.recording.reference_m;
  for (int i = 0; i < recording.axes; ++i)
    r.actuators.push_back(errorFigures(recording.time_s, error.col(i)));
  if (!robot.mechanism) return r;
  comparePoses(robot, has_reference, r);
  addCamera(robot, r);
  return r;
}

}  // namespace knee_robot::report
