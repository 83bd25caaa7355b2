#include "knee_robot/simulation/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/coulomb_memory.h"

namespace knee_robot::simulation {
namespace {

/// The pose in the camera's frame: the inverse of what aligning it does.
mechanism::Pose seen(const CameraSimulation& c, const mechanism::Pose& pose) {
  const double cosine = std::cos(c.rotation_rad), sine = std::sin(c.rotation_rad);
  return {cosine * pose[0] + sine * pose[1] + c.shift_x_m, -sine * pose[0] + cosine * pose[1] + c.shift_z_m,
          pose[2] + c.rotation_rad, pose[3] + c.plate_rad};
}

/// True lengths of every row.
Eigen::MatrixXd trueLengths(const CameraSimulation& c, const Eigen::MatrixXd& encoder_m) {
  Eigen::MatrixXd out = encoder_m;
  for (Eigen::Index i = 0; i < encoder_m.cols(); ++i) {
    const auto leg = static_cast<std::size_t>(i);
    dynamics::CoulombMemory play;
    for (Eigen::Index n = 0; n < encoder_m.rows(); ++n) {
      const double share = play.step(encoder_m(n, i) - encoder_m(std::max<Eigen::Index>(0, n - 1), i), c.play_width_m);
      out(n, i) += c.home_offset_m[leg] - c.half_play_m[leg] * share;
    }
  }
  return out;
}

}  // namespace

void addCamera(const mechanism::Geometry& true_geometry, const CameraSimulation& c, recording::Recording& recording) {
  const mechanism::Mechanism mechanism(true_geometry);
  const Eigen::MatrixXd lengths = trueLengths(c, recording.position_m);
  std::mt19937_64 random(c.seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  recording.mocap = Eigen::MatrixXd::Constant(recording.rows(), 4, std::numeric_limits<double>::quiet_NaN());
  mechanism::Pose last = mechanism::Pose::Zero();
  bool started = false;
  double next_s = recording.time_s.front() + c.delay_s;
  std::size_t shown = 0;
  for (int n = 0; n < recording.rows(); ++n) {
    const double time_s = recording.time_s[static_cast<std::size_t>(n)];
    if (time_s + 1e-9 < next_s) continue;
    next_s += c.period_s;
    while (shown + 1 < recording.time_s.size() && recording.time_s[shown + 1] <= time_s - c.delay_s + 1e-9)
      ++shown;
    const mechanism::Lengths at = lengths.row(static_cast<Eigen::Index>(shown)).transpose();
    const mechanism::ForwardResult found = started ? mechanism::forwardKinematics(mechanism, at, last)
                                                   : mechanism::forwardKinematicsFromHome(mechanism, at);
    const bool missing = uniform(random) < c.missing_share;
    mechanism::Vector4 noise(c.noise_m, c.noise_m, c.noise_rad, c.noise_rad);
    for (int k = 0; k < 4; ++k)
      noise[k] *= normal(random);
    if (!found.ok()) throw Refusal("the simulated camera's mechanism cannot be assembled with the recorded lengths");
    started = true;
    last = found.pose;
    if (!missing) recording.mocap.row(n) = (seen(c, last) + noise).transpose();
  }
}

}  // namespace knee_robot::simulation
