// A force on the platform itself that no name describes: a limb, a magnet, a seal.
#include <algorithm>
#include <cmath>

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class PlatformMaps : public SearchedMachine {
 protected:
  const Candidate& map(const std::string& depends_on) {
    maps_ = mapCandidates(data_.inputs);
    return **std::find_if(maps_.begin(), maps_.end(), [&](const auto& c) { return c->dependsOn(0) == depends_on; });
  }
  Hypothesis everywhere(const Candidate& c) const { return {{&c, -1}, c.shapes(data_.inputs.front(), -1).front()}; }
  /// On all actuators along both recordings, N: a generalized force along one coordinate of the pose.
  template <typename Force>
  Eigen::VectorXd onActuators(int coordinate, Force force) const {
    const Stack& stack = data_.stack;
    Eigen::VectorXd out(stack.axes * stack.size());
    for (Eigen::Index n = 0; n < stack.size(); ++n) {
      const Pick& pick = stack.picks[static_cast<std::size_t>(n)];
      const std::size_t sample = static_cast<std::size_t>(pick.sample);
      const mechanism::Motion& motion = data_.recordings[pick.recording].motion.motion[sample];
      for (int i = 0; i < stack.axes; ++i)
        out[i * stack.size() + n] = data_.inputs[pick.recording].force_per_pose_force[sample](i, coordinate) *
                                    force(motion.pose[coordinate], motion.pose_velocity[coordinate]);
    }
    return out;
  }
  double left(const Candidate& c, const Eigen::VectorXd& force) const {
    const Eigen::MatrixXd columns = effectRows(data_, everywhere(c));
    return (force - columns * Eigen::VectorXd(columns.completeOrthogonalDecomposition().solve(force))).norm() /
           force.norm();
  }

  CandidateList maps_;
};

TEST_F(PlatformMaps, FollowAKneeThatStiffensTowardsItsEnd) {
  const Candidate& knee = map("platform_moment_over_pose_theta_rad");
  EXPECT_TRUE(knee.shared());
  const Eigen::VectorXd force =
      onActuators(2, [](double theta, double) { return -8.0 * std::exp(6.0 * std::abs(theta)) * theta; });
  EXPECT_LT(left(knee, force), 0.1);
  EXPECT_GT(left(map("platform_moment_over_pose_psi_rad"), force), 0.3);
}

TEST_F(PlatformMaps, FollowASealThatRubsByThePlatformsRate) {
  const Eigen::VectorXd force = onActuators(1, [](double, double rate) { return -20.0 * std::tanh(rate / 0.01); });
  EXPECT_LT(left(map("platform_force_over_rate_z_m_per_s"), force), 0.2);
}

TEST_F(PlatformMaps, FollowAMagnetThatBrakesAtOnePlace) {
  const Eigen::MatrixXd heights = [&] {
    Eigen::MatrixXd z(data_.inputs.front().samples(), 1);
    for (int n = 0; n < data_.inputs.front().samples(); ++n)
      z(n, 0) = data_.recordings.front().motion.motion[static_cast<std::size_t>(n)].pose[1];
    return z;
  }();
  const double middle = heights.mean(), wide = 0.3 * (heights.maxCoeff() - heights.minCoeff());
  const Eigen::VectorXd force = onActuators(
      1, [&](double z, double rate) { return -300.0 * rate * std::exp(-0.5 * std::pow((z - middle) / wide, 2)); });
  EXPECT_LT(left(map("platform_force_over_pose_z_m_times_rate"), force), 0.2);
  EXPECT_GT(left(map("platform_force_over_rate_z_m_per_s"), force),
            2.0 * left(map("platform_force_over_pose_z_m_times_rate"), force));
}

TEST_F(PlatformMaps, ComeBackFromAModelByTheirNames) {
  for (const char* signal : {"platform_force_over_pose_x_m", "platform_moment_over_rate_psi_rad_per_s",
                             "platform_moment_over_pose_theta_rad_times_rate"}) {
    const Candidate& own = map(signal);
    const std::vector<double> knots = everywhere(own).shape;
    const auto again = mapCandidate(robot_, signal, 0, knots);
    ASSERT_NE(again, nullptr) << signal;
    EXPECT_EQ(again->columns(data_.inputs.front(), kActuator, knots),
              own.columns(data_.inputs.front(), kActuator, knots));
  }
}

TEST_F(PlatformMaps, AreNoneOnBenchAxes) {
  EXPECT_EQ(
      mapCandidate(identification::syntheticBench(2), "platform_force_over_pose_x_m", 0, {0, 1, 2, 3, 4, 5, 6, 7}),
      nullptr);
}

}  // namespace
}  // namespace knee_robot::tracing
