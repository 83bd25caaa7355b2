// A force on the platform that follows its velocity in several directions at once.
#include <Eigen/LU>
#include <algorithm>
#include <iostream>

#include "knee_robot/mechanism/kinematics.h"
#include "src/tracing/platform_matrices.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr int kOfTheta = 2, kOfPsi = 3;
constexpr double kWheel = 2.0;  ///< angular momentum of a wheel on the platform, about the platform's X, in N m s

/// omega x H, which the actuators bring up, along the coordinates of the pose.
mechanism::Vector4 turnsTheWheel(const mechanism::Motion& motion, const mechanism::Matrix3& rotation) {
  const mechanism::Vector3 normal = rotation.col(2), y = mechanism::Vector3::UnitY();
  const mechanism::Vector3 omega = motion.pose_velocity[kOfTheta] * y + motion.pose_velocity[kOfPsi] * normal;
  const mechanism::Vector3 moment = omega.cross(mechanism::Vector3(kWheel * rotation.col(0)));
  return {0.0, 0.0, moment.dot(y), moment.dot(normal)};
}

class PlatformMatrices : public SearchedMachine {
 protected:
  PlatformMatrices() : maps_(mapCandidates(data_.inputs)) {}
  const Candidate& map(const std::string& depends_on) const {
    return **std::find_if(maps_.begin(), maps_.end(), [&](const auto& c) { return c->dependsOn(0) == depends_on; });
  }
  /// Of all actuators, one below the other.
  Eigen::MatrixXd columns(const std::string& depends_on, const std::vector<double>& shape = {}) const {
    const EffectInput& in = data_.inputs.front();
    Eigen::MatrixXd out(in.axes() * in.samples(), 16);
    for (int i = 0; i < in.axes(); ++i)
      out.middleRows(i * in.samples(), in.samples()) = map(depends_on).columns(in, i, shape);
    return out;
  }
  /// What the wheel asks of the actuators, in the same order.
  Eigen::VectorXd wheel() const {
    const EffectInput& in = data_.inputs.front();
    Eigen::MatrixXd out(in.samples(), in.axes());
    for (int n = 0; n < in.samples(); ++n) {
      const std::size_t sample = static_cast<std::size_t>(n);
      out.row(n) = in.force_per_pose_force[sample] *
                   turnsTheWheel(data_.recordings[0].motion.motion[sample], in.rotation[sample]);
    }
    return out.reshaped();
  }
  /// Its place among the coefficients: of the moment on one coordinate by another one's rate.
  static Eigen::Index at(int moment, int rate) { return 4 * moment + rate; }

  const CandidateList maps_;
};

TEST_F(PlatformMatrices, FollowAWheelThatSpinsOnThePlatform) {
  const Eigen::MatrixXd over_velocity = columns("platform_velocity");
  const Eigen::VectorXd force = wheel(), of_wheel = over_velocity.completeOrthogonalDecomposition().solve(force);
  const double left = (force - over_velocity * of_wheel).norm() / force.norm();
  std::cout << "moment on theta by psi's rate " << of_wheel[at(kOfTheta, kOfPsi)] << " N m s, on psi by theta's rate "
            << of_wheel[at(kOfPsi, kOfTheta)] << " N m s; left " << left << "\n";
  EXPECT_LT(left, 0.05) << "the cosine of psi is not quite one";
  EXPECT_NEAR(of_wheel[at(kOfTheta, kOfPsi)], kWheel, 0.05 * kWheel);
  EXPECT_NEAR(of_wheel[at(kOfPsi, kOfTheta)], -kWheel, 0.05 * kWheel);
  EXPECT_LT(std::abs(of_wheel[at(kOfTheta, kOfTheta)]) + std::abs(of_wheel[at(kOfPsi, kOfPsi)]), 0.1 * kWheel);
}

TEST_F(PlatformMatrices, DoNoWorkForAWheel) {
  const EffectInput& in = data_.inputs.front();
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(16);
  coefficients[at(kOfTheta, kOfPsi)] = kWheel;
  coefficients[at(kOfPsi, kOfTheta)] = -kWheel;
  const Eigen::MatrixXd force = (columns("platform_velocity") * coefficients).reshaped(in.samples(), in.axes());
  double power_W = 0.0, both_W = 0.0;
  for (int n = 0; n < in.samples(); ++n) {
    const mechanism::Motion& motion = data_.recordings[0].motion.motion[static_cast<std::size_t>(n)];
    const mechanism::Vector4 rates = mechanism::lengthJacobian(*robot_.mechanism, motion.pose) * motion.pose_velocity;
    power_W += std::abs(force.row(n) * rates);
    both_W += force.row(n).cwiseAbs() * rates.cwiseAbs();
  }
  EXPECT_GT(both_W, 0.0);
  EXPECT_LT(power_W, 1e-6 * both_W);
}

TEST_F(PlatformMatrices, ForgetTheWayWithTheirTime) {
  // of a short time: the time times the velocity
  const double short_s = 1e-3;
  const Eigen::MatrixXd way = columns("platform_way_of_late", {short_s});
  EXPECT_LT((way - short_s * columns("platform_velocity")).norm(), 1e-3 * way.norm());
  const Eigen::MatrixXd kept = columns("platform_way_of_late", {1e4});
  const EffectInput& in = data_.inputs.front();
  const mechanism::Motion &first = data_.recordings[0].motion.motion.front(),
                          &last = data_.recordings[0].motion.motion.back();
  const int end = in.samples() - 1;
  for (int c = 0; c < 4; ++c) {  // of a long one: the way
    const double lever = in.force_per_pose_force[static_cast<std::size_t>(end)](kActuator, kOfTheta);
    EXPECT_NEAR(kept(kActuator * in.samples() + end, at(kOfTheta, c)) / lever, last.pose[c] - first.pose[c], 1e-3);
  }
}

TEST_F(PlatformMatrices, ComeBackFromAModelByTheirNames) {
  const std::vector<std::pair<std::string, std::vector<double>>> all = {{"platform_velocity", {}},
                                                                        {"platform_way_of_late", {1.5}}};
  for (const auto& [signal, shape] : all) {
    const auto again = mapCandidate(robot_, signal, 0, shape);
    ASSERT_NE(again, nullptr) << signal;
    EXPECT_TRUE(again->shared());
    EXPECT_EQ(again->columns(data_.inputs.front(), kActuator, shape),
              map(signal).columns(data_.inputs.front(), kActuator, shape));
    EXPECT_EQ(again->coefficients(data_.inputs.front()).size(), 16u);
  }
}

TEST_F(PlatformMatrices, AreNoneOnBenchAxes) {
  const mechanism::Robot bench = identification::syntheticBench(2);
  EXPECT_EQ(mapCandidate(bench, "platform_velocity", 0, {}), nullptr);
  EffectInput on_bench;
  on_bench.robot = &bench;
  CandidateList maps;
  addPlatformMatrices({on_bench}, maps);
  EXPECT_TRUE(maps.empty());
}

}  // namespace
}  // namespace knee_robot::tracing
