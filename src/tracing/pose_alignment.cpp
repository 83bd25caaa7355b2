#include "knee_robot/tracing/pose_alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/quantile.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::tracing {
namespace {

constexpr double kMostDelay_s = 0.5;
constexpr double kGrid_s = 0.01;
constexpr double kCorrelated = 0.8;
constexpr double kLongestGap_s = 0.05;
constexpr int kFewest = 20;

const Eigen::Vector4d kWeights(1.0, 1.0, kRadianLength_m, kRadianLength_m);

/// Rows of `values` at other times by straight lines; nan outside, in gaps and beside nan.
Eigen::MatrixXd at(const std::vector<double>& time_s, const Eigen::MatrixXd& values, const std::vector<double>& when) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(when.size()), values.cols(), kNan);
  if (time_s.size() < 2) return out;
  for (std::size_t n = 0; n < when.size(); ++n) {
    const auto next = std::upper_bound(time_s.begin(), time_s.end(), when[n]);
    if (next == time_s.begin() || (next == time_s.end() && when[n] > time_s.back())) continue;
    const auto k = std::min<std::ptrdiff_t>(next - time_s.begin(), static_cast<std::ptrdiff_t>(time_s.size()) - 1);
    const double from = time_s[static_cast<std::size_t>(k - 1)], to = time_s[static_cast<std::size_t>(k)];
    if (to - from > kLongestGap_s) continue;
    const double share = (when[n] - from) / (to - from);
    const auto row = static_cast<Eigen::Index>(n);
    out.row(row) = values.row(k - 1);
    if (share > 0.0) out.row(row) = (1.0 - share) * values.row(k - 1) + share * values.row(k);
  }
  return out;
}

/// Velocity over five samples, weighed so that metres and radians may be added.
Eigen::MatrixXd weighedVelocity(const Eigen::MatrixXd& poses) {
  constexpr Eigen::Index kHalf = 2;
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(poses.rows(), 4, kNan);
  for (Eigen::Index i = kHalf; i + kHalf < poses.rows(); ++i) {
    out.row(i) = (poses.row(i + kHalf) - poses.row(i - kHalf)).cwiseProduct(kWeights.transpose());
  }
  return out;
}

/// Correlation of a with b when a is `lag` samples late. 0 with too few common samples.
double correlationAt(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, Eigen::Index lag, Eigen::Index fewest) {
  double ab = 0.0, aa = 0.0, bb = 0.0;
  Eigen::Index common = 0;
  for (Eigen::Index i = std::max<Eigen::Index>(0, lag); i < a.rows() && i - lag < b.rows(); ++i) {
    const double product = a.row(i).dot(b.row(i - lag));
    if (!std::isfinite(product)) continue;
    ++common;
    ab += product;
    aa += a.row(i).squaredNorm();
    bb += b.row(i - lag).squaredNorm();
  }
  return common < fewest || aa <= 0.0 || bb <= 0.0 ? 0.0 : ab / std::sqrt(aa * bb);
}

/// Adds to the delay what the camera is still late, or sets it to zero when that cannot be told.
void findDelay(const std::vector<double>& time_s, const Eigen::MatrixXd& measured, const Eigen::MatrixXd& camera,
               CameraAlignment& alignment) {
  const double period = std::max(kGrid_s, recording::medianPeriod(time_s));  // cameras take about 100 pictures a second
  std::vector<double> grid;
  const auto samples = static_cast<std::size_t>(std::min(1e6, (time_s.back() - time_s.front()) / period));
  for (std::size_t n = 0; n < samples; ++n)
    grid.push_back(time_s.front() + static_cast<double>(n) * period);
  const Eigen::MatrixXd m = weighedVelocity(at(time_s, measured, grid)), c = weighedVelocity(at(time_s, camera, grid));
  const auto most = static_cast<Eigen::Index>(std::ceil(kMostDelay_s / period));
  std::vector<double> curve;
  for (Eigen::Index lag = -most; lag <= most; ++lag)
    curve.push_back(correlationAt(c, m, lag, kFewest));
  const auto best = static_cast<std::size_t>(std::max_element(curve.begin(), curve.end()) - curve.begin());
  alignment.correlation = curve[best];
  alignment.delay_known = false;
  if (curve[best] < kCorrelated || best == 0 || best + 1 == curve.size()) {
    alignment.delay_s = 0.0;
    return;
  }
  const double left = curve[best - 1], right = curve[best + 1], bend = left - 2.0 * curve[best] + right;
  const double between = bend < 0.0 ? 0.5 * (left - right) / bend : 0.0;
  alignment.delay_s += (static_cast<double>(best) - static_cast<double>(most) + between) * period;
  alignment.delay_known = true;
}

/// Least squares over the chosen rows. The turn is found by Gauss-Newton on points and theta together; shift and plate
/// follow.
void fitFrame(const Eigen::MatrixXd& camera, const Eigen::MatrixXd& measured, const std::vector<Eigen::Index>& rows,
              CameraAlignment& a) {
  Eigen::Vector4d camera_mean = Eigen::Vector4d::Zero(), measured_mean = camera_mean;
  for (const Eigen::Index i : rows) {
    camera_mean += camera.row(i).transpose() / static_cast<double>(rows.size());
    measured_mean += measured.row(i).transpose() / static_cast<double>(rows.size());
  }
  a.rotation_rad = measured_mean[2] - camera_mean[2];
  for (int step = 0; step < 20; ++step) {
    const double c = std::cos(a.rotation_rad), s = std::sin(a.rotation_rad);
    double slope = 0.0, bend = 0.0;
    for (const Eigen::Index i : rows) {
      const Eigen::Vector4d u = camera.row(i).transpose() - camera_mean,
                            v = measured.row(i).transpose() - measured_mean;
      const double x = c * u[0] + s * u[1], z = -s * u[0] + c * u[1];  // derivative by the turn: (z, -x)
      slope += (v[0] - x) * z - (v[1] - z) * x;
      bend += x * x + z * z;
      slope += kRadianLength_m * kRadianLength_m * (measured(i, 2) - camera(i, 2) - a.rotation_rad);
      bend += kRadianLength_m * kRadianLength_m;
    }
    a.rotation_rad += slope / bend;
    if (std::abs(slope) < 1e-14 * bend) break;
  }
  a.shift_x_m = a.shift_z_m = 0.0;
  a.plate_rad = measured_mean[3] - camera_mean[3];
  const Eigen::Vector4d turned = cameraInRobot(a, camera_mean);
  a.shift_x_m = measured_mean[0] - turned[0];
  a.shift_z_m = measured_mean[1] - turned[1];
  a.rows = static_cast<int>(rows.size());
}

/// Fits, then leaves out rows beyond three times the median distance and fits again, until the choice stays the same.
void fitRobustly(const Eigen::MatrixXd& camera, const Eigen::MatrixXd& measured, const std::vector<Eigen::Index>& all,
                 CameraAlignment& a) {
  std::vector<Eigen::Index> rows = all;
  for (int round = 0; round < 30; ++round) {
    fitFrame(camera, measured, rows, a);
    std::vector<double> distance;
    for (const Eigen::Index i : all) {
      const Eigen::Vector4d error = cameraInRobot(a, camera.row(i).transpose()) - measured.row(i).transpose();
      distance.push_back(error.cwiseProduct(kWeights).norm());
    }
    const double limit = std::max(1e-9, 3.0 * median(distance));
    std::vector<Eigen::Index> kept;
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (distance[n] <= limit) kept.push_back(all[n]);
    }
    if (kept == rows) return;
    rows = std::move(kept);
  }
}

/// Rows with a camera pose beside a known and regular one; with all known ones when there are too few.
std::vector<Eigen::Index> usableRows(const Eigen::MatrixXd& camera, const PosePath& measured, double condition_max) {
  std::vector<Eigen::Index> regular, known;
  for (Eigen::Index i = 0; i < camera.rows(); ++i) {
    if (!camera.row(i).allFinite() || !measured.pose.row(i).allFinite()) continue;
    known.push_back(i);
    if (measured.condition[i] < condition_max) regular.push_back(i);
  }
  return regular.size() >= static_cast<std::size_t>(kFewest) ? regular : known;
}

/// The camera's poses in the robot's frame without those that would spoil the correlation: wrong pictures, and poses
/// beyond a singularity, where the encoders' are not the camera's.
Eigen::MatrixXd trustedPoses(const CameraAlignment& rough, const Eigen::MatrixXd& camera, const PosePath& measured,
                             const std::vector<Eigen::Index>& rows) {
  std::vector<double> all;
  for (const Eigen::Index i : rows)
    all.push_back(poseDistance(cameraInRobot(rough, camera.row(i).transpose()), measured.pose.row(i).transpose()));
  const double limit = 5.0 * median(all);
  Eigen::MatrixXd trusted = Eigen::MatrixXd::Constant(camera.rows(), 4, kNan);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    if (all[n] <= limit) trusted.row(rows[n]) = cameraInRobot(rough, camera.row(rows[n]).transpose()).transpose();
  }
  return trusted;
}

}  // namespace

PosePath posesOf(const mechanism::Mechanism& mechanism, const Eigen::MatrixXd& lengths_m) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  PosePath path;
  path.pose = Eigen::MatrixXd::Constant(lengths_m.rows(), 4, nan);
  path.condition = Eigen::VectorXd::Constant(lengths_m.rows(), nan);
  bool started = false;
  mechanism::Pose last = mechanism::Pose::Zero();
  for (Eigen::Index i = 0; i < lengths_m.rows(); ++i) {
    const mechanism::Lengths lengths = lengths_m.row(i).transpose();
    const mechanism::ForwardResult found = started ? mechanism::forwardKinematics(mechanism, lengths, last)
                                                   : mechanism::forwardKinematicsFromHome(mechanism, lengths);
    if (!found.ok()) {
      ++path.unknown;
      continue;
    }
    started = true;
    last = found.pose;
    path.pose.row(i) = found.pose.transpose();
    path.condition[i] = found.condition_bound;
  }
  return path;
}

mechanism::Pose cameraInRobot(const CameraAlignment& a, const mechanism::Pose& pose) {
  // A turn about Y takes Z towards X: x' = x cos + z sin, z' = -x sin + z cos.
  const double c = std::cos(a.rotation_rad), s = std::sin(a.rotation_rad);
  return {c * pose[0] + s * pose[1] + a.shift_x_m, -s * pose[0] + c * pose[1] + a.shift_z_m, pose[2] + a.rotation_rad,
          pose[3] + a.plate_rad};
}

double poseDistance(const mechanism::Pose& a, const mechanism::Pose& b) {
  return (a - b).cwiseProduct(kWeights).norm();
}

Eigen::MatrixXd cameraAtRows(const recording::Recording& recording, double delay_s) {
  std::vector<double> pictures_s, when_s = recording.time_s;
  Eigen::MatrixXd poses(recording.rows(), 4);
  Eigen::Index pictures = 0;
  for (int i = 0; i < recording.rows(); ++i) {
    if (!recording.mocap.row(i).allFinite()) continue;
    pictures_s.push_back(recording.time_s[static_cast<std::size_t>(i)]);
    poses.row(pictures++) = recording.mocap.row(i);
  }
  for (double& t : when_s)
    t += delay_s;
  return at(pictures_s, poses.topRows(pictures), when_s);
}

/// A turned frame mixes X and Z and with it moves the peak of the correlation, and a delay moves the frame: so in
/// turns.
CameraAlignment alignCamera(const recording::Recording& recording, const PosePath& measured, double condition_max) {
  constexpr int kRounds = 4;
  CameraAlignment alignment;
  for (int round = 0;; ++round) {
    const Eigen::MatrixXd camera = cameraAtRows(recording, alignment.delay_s);
    const std::vector<Eigen::Index> rows = usableRows(camera, measured, condition_max);
    if (rows.size() < static_cast<std::size_t>(kFewest)) return alignment;
    fitRobustly(camera, measured.pose, rows, alignment);
    alignment.known = true;
    if (round == kRounds || (round > 0 && !alignment.delay_known)) return alignment;
    findDelay(recording.time_s, measured.pose, trustedPoses(alignment, camera, measured, rows), alignment);
  }
}

bool otherSolution(const mechanism::Mechanism& mechanism, const mechanism::Lengths& lengths,
                   const mechanism::Pose& camera, const mechanism::Pose& measured, mechanism::Pose& other) {
  constexpr double kApart_m = 1e-3;
  const mechanism::ForwardResult found = mechanism::forwardKinematics(mechanism, lengths, camera);
  if (!found.ok() || poseDistance(found.pose, measured) < kApart_m) return false;
  other = found.pose;
  return poseDistance(camera, other) < poseDistance(camera, measured);
}

}  // namespace knee_robot::tracing
