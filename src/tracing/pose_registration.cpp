#include "knee_robot/tracing/pose_registration.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/quantile.h"
#include "knee_robot/recording/signals.h"
#include "knee_robot/tracing/pose_alignment.h"

namespace knee_robot::tracing {
namespace {

constexpr double kCoarse_s = 0.04, kFine_s = 0.005;
constexpr double kReach_s = 0.06;  ///< half of the time over which a speed is measured
constexpr double kSpeedsCorrelated = 0.8;
constexpr double kLeastOverlap_s = 4.0;
constexpr double kCaptureGap_s = 0.05;
constexpr std::size_t kFewestFrames = 50;

Eigen::Isometry3d platformIn(const mechanism::Pose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = mechanism::platformRotation(pose);
  out.translation() << pose[0], 0.0, pose[1];
  return out;
}

mechanism::Pose poseOf(const Eigen::Isometry3d& platform) {
  const Eigen::Matrix3d r = platform.linear();
  return {platform.translation()[0], platform.translation()[2], std::atan2(r(0, 2), r(2, 2)),
          std::atan2(r(1, 0), r(1, 1))};
}

/// Platforms at increasing times.
struct Track {
  std::vector<double> time_s;
  std::vector<Eigen::Isometry3d> platform;

  /// Between two neighbours at most 50 ms apart; false elsewhere.
  bool at(double time, Eigen::Isometry3d& out) const {
    const auto next = std::lower_bound(time_s.begin(), time_s.end(), time);
    if (next == time_s.end() || (next == time_s.begin() && *next > time)) return false;
    const auto k = static_cast<std::size_t>(next - time_s.begin());
    if (time_s[k] == time) {
      out = platform[k];
      return true;
    }
    if (time_s[k] - time_s[k - 1] > kCaptureGap_s) return false;
    const double share = (time - time_s[k - 1]) / (time_s[k] - time_s[k - 1]);
    const Eigen::Quaterniond a(platform[k - 1].linear()), b(platform[k].linear());
    out.linear() = a.slerp(share, b).toRotationMatrix();
    out.translation() = (1.0 - share) * platform[k - 1].translation() + share * platform[k].translation();
    return true;
  }
};

Track encoderTrack(const recording::Recording& recording, const PosePath& measured) {
  Track track;
  for (int i = 0; i < recording.rows(); ++i) {
    if (!measured.pose.row(i).allFinite()) continue;
    track.time_s.push_back(recording.time_s[static_cast<std::size_t>(i)]);
    track.platform.push_back(platformIn(measured.pose.row(i).transpose()));
  }
  return track;
}

Track captureTrack(const recording::MarkerPoses& capture) {
  Track track;
  for (std::size_t i = 0; i < capture.time_s.size(); ++i) {
    if (!capture.known[i]) continue;
    track.time_s.push_back(capture.time_s[i]);
    track.platform.push_back(capture.pose[i]);
  }
  return track;
}

/// Linear and angular speed (m/s, the angle weighed with a platform's radius) every `period_s`; nan in gaps.
Eigen::MatrixXd speeds(const Track& track, double period_s) {
  const double from = track.time_s.front();
  const auto n = static_cast<Eigen::Index>((track.time_s.back() - from) / period_s) + 1;
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(n, 2, kNan);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double t = from + period_s * static_cast<double>(k);
    Eigen::Isometry3d before, after;
    if (!track.at(t - kReach_s, before) || !track.at(t + kReach_s, after)) continue;
    out(k, 0) = (after.translation() - before.translation()).norm() / (2.0 * kReach_s);
    out(k, 1) =
        kRadianLength_m * Eigen::AngleAxisd(before.linear().transpose() * after.linear()).angle() / (2.0 * kReach_s);
  }
  return out;
}

/// Correlation of both speeds, means removed, when a is `lag` samples after b.
double speedCorrelation(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, Eigen::Index lag, Eigen::Index least) {
  const Eigen::Index first = std::max<Eigen::Index>(0, lag), last = std::min(a.rows(), b.rows() + lag);
  double n = 0.0;
  Eigen::Array2d sa = Eigen::Array2d::Zero(), sb = sa, saa = sa, sbb = sa, sab = sa;
  for (Eigen::Index i = first; i < last; ++i) {
    const Eigen::Array2d x = a.row(i).transpose().array(), y = b.row(i - lag).transpose().array();
    if (!std::isfinite(x.sum() + y.sum())) continue;
    n += 1.0;
    sa += x;
    sb += y;
    saa += x * x;
    sbb += y * y;
    sab += x * y;
  }
  if (n < static_cast<double>(least)) return -1.0;
  const double ab = (sab - sa * sb / n).sum(), aa = (saa - sa * sa / n).sum(), bb = (sbb - sb * sb / n).sum();
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : -1.0;
}

/// Delay by all lags on a coarse grid, then by a fine one around the best.
void findDelay(const Track& encoders, const Track& capture, RegisteredCapture& out) {
  const double offset = capture.time_s.front() - encoders.time_s.front();
  const auto search = [&](double period_s, double around_s, double reach_s) {
    const Eigen::MatrixXd a = speeds(capture, period_s), b = speeds(encoders, period_s);
    const auto least = static_cast<Eigen::Index>(kLeastOverlap_s / period_s);
    // A capture sample k and an encoder sample k - lag lie offset + lag * period apart.
    const double middle = (around_s - offset) / period_s;
    const auto low =
        std::max<Eigen::Index>(-b.rows(), static_cast<Eigen::Index>(std::floor(middle - reach_s / period_s)));
    const auto high =
        std::min<Eigen::Index>(a.rows(), static_cast<Eigen::Index>(std::ceil(middle + reach_s / period_s)));
    std::vector<double> curve;
    for (Eigen::Index lag = low; lag <= high; ++lag)
      curve.push_back(speedCorrelation(a, b, lag, least));
    if (curve.empty()) return -1.0;
    const auto best = static_cast<std::size_t>(std::max_element(curve.begin(), curve.end()) - curve.begin());
    double between = 0.0;
    if (best > 0 && best + 1 < curve.size()) {
      const double bend = curve[best - 1] - 2.0 * curve[best] + curve[best + 1];
      if (bend < 0.0) between = 0.5 * (curve[best - 1] - curve[best + 1]) / bend;
    }
    out.delay_s = offset + (static_cast<double>(low) + static_cast<double>(best) + between) * period_s;
    return curve[best];
  };
  const double everything = 1e9;
  out.correlation = search(kCoarse_s, 0.0, everything);
  if (out.correlation > 0.0) out.correlation = search(kFine_s, out.delay_s, 2.0 * kCoarse_s);
}

/// Rigid motion that brings the platform's joints of the capture onto those of forward kinematics, robustly.
void registerFrame(const mechanism::Mechanism& mechanism, const recording::Recording& recording,
                   const PosePath& measured, const Track& capture, double condition_max, RegisteredCapture& out) {
  std::vector<Eigen::Isometry3d> seen, known;
  for (int i = 0; i < recording.rows(); ++i) {
    Eigen::Isometry3d platform;
    if (!measured.pose.row(i).allFinite() || measured.condition[i] >= condition_max) continue;
    if (!capture.at(recording.time_s[static_cast<std::size_t>(i)] + out.delay_s, platform)) continue;
    seen.push_back(platform);
    known.push_back(platformIn(measured.pose.row(i).transpose()));
  }
  if (seen.size() < kFewestFrames)
    throw Refusal(recording.path + ": only " + std::to_string(seen.size()) +
                  " rows away from singularities have a picture at their time; the capture cannot be aligned");
  std::vector<std::size_t> rows(seen.size());
  for (std::size_t k = 0; k < rows.size(); ++k)
    rows[k] = k;
  for (int round = 0; round < 20; ++round) {
    Eigen::Matrix3Xd from(3, 4 * static_cast<Eigen::Index>(rows.size())), to(3, from.cols());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      for (std::size_t j = 0; j < 4; ++j) {
        const auto at = static_cast<Eigen::Index>(4 * k + j);
        from.col(at) = seen[rows[k]] * mechanism.platform_points[j];
        to.col(at) = known[rows[k]] * mechanism.platform_points[j];
      }
    }
    out.frame.matrix() = Eigen::umeyama(from, to, false);
    out.rms_m = std::sqrt((to - out.frame * from).colwise().squaredNorm().mean());
    std::vector<double> distance;
    for (std::size_t k = 0; k < seen.size(); ++k)
      distance.push_back(poseDistance(poseOf(out.frame * seen[k]), poseOf(known[k])));
    const double limit = std::max(1e-9, 3.0 * median(distance));
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (distance[k] <= limit) kept.push_back(k);
    }
    if (kept == rows) break;
    rows = std::move(kept);
  }
}

}  // namespace

RegisteredCapture registerCapture(const mechanism::Robot& robot, const recording::Recording& recording,
                                  const recording::MarkerPoses& capture, double condition_max) {
  if (!robot.mechanism) throw InputError(robot.path + " describes separate axes; markers belong to a platform");
  recording::requireAxes(recording, robot.axes(), robot.path);
  RegisteredCapture out;
  out.notes = capture.notes;
  const PosePath measured = posesOf(*robot.mechanism, recording.position_m);
  const Track encoders = encoderTrack(recording, measured), seen = captureTrack(capture);
  if (encoders.time_s.size() < kFewestFrames || seen.time_s.size() < kFewestFrames)
    throw Refusal(recording.path + ": too few poses to align (" + std::to_string(encoders.time_s.size()) +
                  " of the encoders, " + std::to_string(seen.time_s.size()) + " of the capture)");
  findDelay(encoders, seen, out);
  if (out.correlation < kSpeedsCorrelated)
    throw Refusal(recording.path + ": the platform's speeds in capture and recording do not correlate (at most " +
                  shortNumber(out.correlation, 3) + "): is this the same movement, and at least " +
                  shortNumber(kLeastOverlap_s) + " s of it?");
  registerFrame(*robot.mechanism, recording, measured, seen, condition_max, out);

  out.pose = Eigen::MatrixXd::Constant(recording.rows(), 4, kNan);
  double y_squares = 0.0, tilt_squares = 0.0;
  for (int i = 0; i < recording.rows(); ++i) {
    Eigen::Isometry3d platform;
    if (!seen.at(recording.time_s[static_cast<std::size_t>(i)] + out.delay_s, platform)) continue;
    platform = out.frame * platform;
    out.pose.row(i) = poseOf(platform).transpose();
    y_squares += std::pow(platform.translation()[1], 2);
    tilt_squares += std::pow(std::asin(std::clamp(platform.linear()(1, 2), -1.0, 1.0)), 2);
    ++out.pictures;
  }
  out.out_of_plane_m = std::sqrt(y_squares / out.pictures);
  out.tilt_rad = std::sqrt(tilt_squares / out.pictures);
  const Eigen::AngleAxisd turn(out.frame.linear());
  out.notes.push_back("Time: the capture's clock minus the recording's is " + shortNumber(out.delay_s, 6) +
                      " s (cross-correlation of the platform's speeds, " + shortNumber(out.correlation, 4) +
                      "); pictures were moved by that and read between neighbours by straight lines.");
  out.notes.push_back("Frame: turned by " + shortNumber(kDegrees * turn.angle(), 4) + " deg about (" +
                      shortNumber(turn.axis()[0], 3) + ", " + shortNumber(turn.axis()[1], 3) + ", " +
                      shortNumber(turn.axis()[2], 3) + ") and shifted by (" +
                      shortNumber(out.frame.translation()[0], 4) + ", " + shortNumber(out.frame.translation()[1], 4) +
                      ", " + shortNumber(out.frame.translation()[2], 4) +
                      ") m; the platform's joints then differ from forward kinematics by " +
                      shortNumber(1e3 * out.rms_m, 3) + " mm rms.");
  out.notes.push_back("What the mechanism cannot do: " + shortNumber(1e3 * out.out_of_plane_m, 3) +
                      " mm rms along Y, " + shortNumber(kDegrees * out.tilt_rad, 3) + " deg rms about the turned X.");
  return out;
}

}  // namespace knee_robot::tracing
