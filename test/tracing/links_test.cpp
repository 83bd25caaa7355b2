// What relaxes and what yields along a line between base and platform: columns by hand-worked numbers.
#include <algorithm>
#include <cmath>

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr double kGrid_s = 0.01;
constexpr int kRows = 1000;

/// The platform stays where a line from the base's X = 0.3 m to its middle points 0.6 back and 0.8 up, and is said to
/// go up; every actuator acts along one coordinate of the pose. The line's rate is 0.8 of the platform's.
class Links : public testing::Test {
 protected:
  Links() {
    recording::Signals& s = observation_.signals;
    s.period_s = kGrid_s;
    s.force_N = s.position_m = s.velocity_m_per_s = Eigen::MatrixXd::Zero(kRows, 4);
    mechanism::Motion stands;
    stands.pose = mechanism::Pose(0.0, 0.4, 0.0, 0.0);
    observation_.motion.motion.assign(kRows, stands);
    for (int n = 0; n < kRows; ++n)
      s.time_s.push_back(kGrid_s * n);
    input_.observation = &observation_;
    input_.rotation.assign(kRows, mechanism::Matrix3::Identity());
    input_.force_per_pose_force.assign(kRows, mechanism::Matrix4::Identity());
  }
  void goesUp(int from, int to, double speed_m_per_s) {
    for (int n = from; n < to; ++n)
      observation_.motion.motion[static_cast<std::size_t>(n)].pose_velocity[1] = speed_m_per_s;
  }
  /// What the line resists with per unit of its coefficient: `actuator` 0 and 1 act along X and Z.
  Eigen::VectorXd along(const std::string& name, const std::vector<double>& shape, int actuator = 1) const {
    const auto link = std::find_if(all_.begin(), all_.end(), [&](const auto& c) { return c->name() == name; });
    return (*link)->columns(input_, actuator, shape).col(0) / (actuator == 1 ? 0.8 : -0.6);
  }
  Eigen::VectorXd stretched(double relaxation_s) const {
    return along("viscoelastic_link", {0.3, 0.0, 0.0, 0.0, relaxation_s});
  }
  Eigen::VectorXd yielded(double yield_m) const {
    return along("elastoplastic_link", {0.3, 0.0, 0.0, 0.0, 0.0, yield_m});
  }

  const CandidateList all_ = namedCandidates(identification::syntheticRobot());
  identification::Observation observation_;
  EffectInput input_;
};

TEST_F(Links, ASpringThatRelaxesIsStretchedAsFarAsItCannotRelaxMeanwhile) {
  goesUp(0, 100, 0.05);
  EXPECT_NEAR(stretched(30.0)[99], 0.04 * 30.0 * (1.0 - std::exp(-1.0 / 30.0)), 1e-9) << "nearly the whole way";
  EXPECT_NEAR(stretched(0.05)[99], 0.05 * 0.04, 1e-9) << "its time times the rate: a damper";
  EXPECT_TRUE(along("viscoelastic_link", {0.3, 0.0, 0.0, 0.0, 1.0}, 0).isApprox(stretched(1.0), 1e-9))
      << "along the line";
}

TEST_F(Links, ASpringThatRelaxesDoesSoAtRestWithItsTime) {
  goesUp(0, 100, -0.05);
  const Eigen::VectorXd m = stretched(2.0);
  EXPECT_LT(m[99], 0.0) << "it pushes where it was shortened";
  EXPECT_NEAR(m[499] / m[99], std::exp(-2.0), 1e-9);
}

TEST_F(Links, ACableBuildsUpOverItsWayStaysAndTurnsItsSign) {
  goesUp(0, 601, 0.05);
  goesUp(601, 801, 0.0);
  goesUp(801, kRows, -0.05);
  const Eigen::VectorXd share = yielded(0.004);
  EXPECT_EQ(share[0], 0.0);
  EXPECT_NEAR(share[10], 1.0 - std::exp(-1.0), 1e-9) << "4 mm of the line";
  EXPECT_NEAR(share[300], 1.0, 1e-9);
  EXPECT_NEAR(share[800], 1.0, 1e-9) << "it keeps at rest";
  EXPECT_NEAR(share[821], -1.0 + 2.0 * std::exp(-20.5 / 10.0), 1e-9) << "half a step of 0.4 mm from rest, then 20";
  EXPECT_NEAR(share[kRows - 1], -1.0, 1e-6);
  EXPECT_NEAR(yielded(0.04)[10], 1.0 - std::exp(-0.1), 1e-9) << "a longer way";
}

TEST_F(Links, ARopeRubsWithTheSignOfItsRateAndIsSmoothBelowItsSpeed) {
  goesUp(0, 100, 0.05);
  goesUp(100, 200, -0.005);
  const Eigen::VectorXd share = along("line_friction", {0.3, 0.0, 0.0, 0.0, 0.0, 0.004});
  EXPECT_NEAR(share[50], 0.04 / std::hypot(0.04, 0.004), 1e-9);
  EXPECT_NEAR(share[150], -std::sqrt(0.5), 1e-9) << "4 mm/s of the line";
  EXPECT_EQ(share[250], 0.0);
}

}  // namespace
}  // namespace knee_robot::tracing
