#include "knee_robot/base/constants.h"
#include "knee_robot/report/compare.h"

namespace knee_robot::report {
namespace {

void fillFigures(const mechanism::Mechanism& mechanism, const recording::Recording& recording,
                 const tracing::PosePath& measured, const Eigen::MatrixXd& reference, double condition_max,
                 CameraComparison& out) {
  const Eigen::MatrixXd error = out.pose - measured.pose, of_reference = out.pose - reference;
  Eigen::MatrixXd nearest = error, regular = Eigen::MatrixXd::Constant(error.rows(), 4, kNan);
  for (Eigen::Index i = 0; i < error.rows(); ++i) {
    if (!error.row(i).allFinite()) continue;
    mechanism::Pose other;
    const Eigen::Vector4d camera = out.pose.row(i).transpose();
    if (tracing::otherSolution(mechanism, recording.position_m.row(i).transpose(), camera,
                               measured.pose.row(i).transpose(), other)) {
      nearest.row(i) = (camera - other).transpose();
      out.other_to_s = recording.time_s[static_cast<std::size_t>(i)];
      if (out.other_solution++ == 0) out.other_from_s = out.other_to_s;
    } else if (measured.condition[i] < condition_max) {
      regular.row(i) = error.row(i);
    }
  }
  for (int k = 0; k < 4; ++k) {
    out.error[k] = errorFigures(recording.time_s, error.col(k));
    out.error_regular[k] = errorFigures(recording.time_s, regular.col(k));
    out.error_nearest[k] = errorFigures(recording.time_s, nearest.col(k));
    out.reference_error[k] = errorFigures(recording.time_s, of_reference.col(k));
  }
}

}  // namespace

CameraComparison compareCamera(const mechanism::Mechanism& mechanism, const recording::Recording& recording,
                               const tracing::PosePath& measured, const Eigen::MatrixXd& reference,
                               double condition_max) {
  CameraComparison out;
  out.alignment = tracing::alignCamera(recording, measured, condition_max);
  if (!out.alignment.known) return out;
  out.pose = tracing::cameraAtRows(recording, out.alignment.delay_s);
  for (Eigen::Index i = 0; i < out.pose.rows(); ++i)
    out.pose.row(i) = tracing::cameraInRobot(out.alignment, out.pose.row(i).transpose()).transpose();
  fillFigures(mechanism, recording, measured, reference, condition_max, out);
  return out;
}

}  // namespace knee_robot::report
