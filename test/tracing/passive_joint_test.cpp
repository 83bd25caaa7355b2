#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/tracing/trace.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLong_s = 40.0, kWidth_rad = 0.12, kPositive_Nm = 3.0, kNegative_Nm = 6.0;

/// The platform's theta turns somebody's knee, which pushes back with this moment.
double moment(double theta) {
  return kPositive_Nm * std::exp(theta / kWidth_rad) - kNegative_Nm * std::exp(-theta / kWidth_rad);
}

/// `knee`: 1, or 0 for nobody.
recording::Recording kneeRecording(const mechanism::Robot& robot, int variant, double knee) {
  std::mt19937 random(static_cast<unsigned>(variant) + 1u);
  std::normal_distribution<double> noise(0.0, 0.3);
  recording::Recording r = identification::syntheticRecording(robot, identification::syntheticModel(robot), variant,
                                                              kLong_s, [&] { return noise(random); });
  const std::vector<identification::Sines> sines = identification::syntheticMotion(false, variant);
  for (Eigen::Index k = 0; k < r.force_N.rows(); ++k) {
    const double middle_s = 0.01 * static_cast<double>(k) + 0.005;
    const mechanism::Pose pose = identification::syntheticState(robot, sines, middle_s, kLong_s).motion.pose;
    const mechanism::Vector4 on_pose(0.0, 0.0, knee * moment(pose[2]), 0.0);
    r.force_N.row(k) += mechanism::lengthJacobian(*robot.mechanism, pose).transpose().inverse() * on_pose;
  }
  return r;
}

TraceResult tracedKnee(const mechanism::Robot& robot, double knee) {
  const std::vector<recording::Recording> recordings = {kneeRecording(robot, 0, knee), kneeRecording(robot, 1, knee)};
  TraceOptions options;
  options.surrogates = 5;
  return trace(robot, recordings,
               identification::observeAll(robot, identification::columnsOf(robot), recordings, options.observation),
               options);
}

TEST(PassiveJoint, IsNamedWithItsWidthAndBothMoments) {
  const TraceResult result = tracedKnee(identification::syntheticRobot(), 1.0);
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& e = result.effects[0];
  EXPECT_EQ(e.hypothesis.place.candidate->name(), "passive_joint");
  std::cout << "width " << e.hypothesis.shape[1] << " rad, moments " << e.coefficients.transpose() << " N m\n";
  EXPECT_TRUE(e.transfers);
  EXPECT_EQ(e.hypothesis.shape[0], 2.0) << "theta";
  EXPECT_NEAR(e.hypothesis.shape[1], kWidth_rad, 0.1 * kWidth_rad);
  EXPECT_NEAR(e.coefficients[0], kPositive_Nm, 0.25 * kPositive_Nm);
  EXPECT_NEAR(e.coefficients[1], kNegative_Nm, 0.25 * kNegative_Nm);
  ASSERT_EQ(e.coefficients.size(), 4);
  EXPECT_LT(std::abs(e.coefficients[2]), 1.0) << "it does not damp";
  EXPECT_LT(std::abs(e.coefficients[3]), 0.3) << "nor yield";
  for (int i = 0; i < 4; ++i)
    EXPECT_LT(result.after_rms_N[i], 1.5 * result.floor_N[i]) << "actuator " << i + 1;
}

TEST(PassiveJoint, IsNotFoundWhereNobodyIsOnThePlatform) {
  EXPECT_TRUE(tracedKnee(identification::syntheticRobot(), 0.0).effects.empty());
}

}  // namespace
}  // namespace knee_robot::tracing
