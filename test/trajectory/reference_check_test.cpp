#include "knee_robot/trajectory/reference_check.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "knee_robot/base/errors.h"
#include "test/trajectory/robots.h"

namespace knee_robot::trajectory {
namespace {

const mechanism::Pose kStart(0.05, 0.65, 0.10, -0.10);

/// `points` copies of a pose's lengths: a reference that stands still.
Reference standing(const mechanism::Vector4& point, Space space, Eigen::Index points = 200) {
  Reference reference;
  reference.name = "file.txt";
  reference.space = space;
  reference.points = point.transpose().replicate(points, 1);
  return reference;
}

/// A platform reference that moves coordinate `axis` of kStart smoothly by `distance` within two seconds.
Reference moving(int axis, double distance) {
  Reference reference = standing(kStart, Space::Platform, 201);
  for (int k = 0; k <= 200; ++k) {
    const double s = k / 200.0;
    reference.points(k, axis) += distance * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
  }
  return reference;
}

std::string verdict(const Reference& reference, const mechanism::Robot& robot) {
  const ReferenceCheck check = checkReference(reference, robot);
  return check.violation ? check.violation->sentence : "";
}

TEST(ReferenceCheck, AcceptsASmoothMovementAndReportsEveryMargin) {
  const mechanism::Robot robot = testRobot();
  const ReferenceCheck check = checkReference(moving(1, 0.1), robot);
  ASSERT_TRUE(check.ok()) << check.violation->sentence;
  ASSERT_EQ(check.margins.size(), 7u);
  for (const Margin& margin : check.margins)
    EXPECT_GT(margin.left, 0.0) << nameOf(margin.quantity);
  EXPECT_EQ(check.lengths.rows(), 201);
  EXPECT_NEAR(check.poses(200, 1), 0.75, 1e-9);
  EXPECT_NEAR(check.poses(100, 1), 0.70, 1e-9);
  EXPECT_EQ(requirePlayable(moving(1, 0.1), robot).lengths, check.lengths);
}

TEST(ReferenceCheck, FollowsActuatorLengthsToThePosesThatTheyCameFrom) {
  const mechanism::Robot robot = testRobot();
  const Reference platform = moving(3, 0.2);
  Reference actuator = standing(kStart, Space::Actuator, 201);
  actuator.points = checkReference(platform, robot).lengths;
  const ReferenceCheck check = checkReference(actuator, robot);
  ASSERT_TRUE(check.ok()) << check.violation->sentence;
  EXPECT_LE((check.poses - platform.points).cwiseAbs().maxCoeff(), 1e-8);
  for (Eigen::Index i = 0; i < 4; ++i)
    actuator.points.col(i).array() -= robot.actuators[i].home_length_m;
  actuator.space = Space::Relative;
  EXPECT_LE((checkReference(actuator, robot).poses - platform.points).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(ReferenceCheck, NamesLineActuatorValueLimitAndRemedyOfALengthOutOfRange) {
  mechanism::Robot robot = testRobot();
  Reference reference = standing(mechanism::legLengths(*robot.mechanism, kStart), Space::Actuator);
  reference.first_line = 3;
  reference.points(40, 1) = 0.49;
  reference.points(41, 2) = 1.02;
  EXPECT_EQ(
      verdict(reference, robot),
      "file.txt:43: actuator 2 is sent to 0.49 m, below its minimum of 0.5 m in robot.yaml; move the reference up by "
      "0.01 m");
  reference.points(39, 2) = 1.02;
  EXPECT_EQ(verdict(reference, robot).rfind("file.txt:42: actuator 3 is sent to 1.02 m, above its maximum of 1 m", 0),
            0u);
}

TEST(ReferenceCheck, SuggestsTheSpaceThatAMisdeclaredFileProbablyHas) {
  const mechanism::Robot robot = testRobot();
  EXPECT_NE(verdict(standing(kStart, Space::Actuator), robot).find("--space platform"), std::string::npos);
  EXPECT_NE(verdict(standing({0.0, 0.001, 0.0, 0.0}, Space::Actuator), robot).find("--space relative"),
            std::string::npos);
  EXPECT_NE(verdict(standing(mechanism::legLengths(*robot.mechanism, kStart), Space::Relative), robot)
                .find("--space actuator"),
            std::string::npos);
}

TEST(ReferenceCheck, RefusesAJumpByItsVelocityAndABendByItsAcceleration) {
  const mechanism::Robot robot = testRobot();
  const mechanism::Lengths lengths = mechanism::legLengths(*robot.mechanism, kStart);
  Reference jump = standing(lengths, Space::Actuator);
  jump.points.bottomRows(100).col(3).array() += 0.0031;
  ReferenceCheck check = checkReference(jump, robot);
  ASSERT_FALSE(check.ok());
  EXPECT_EQ(check.violation->at.quantity, Quantity::Velocity);
  EXPECT_EQ(check.violation->at.line, 101);
  EXPECT_EQ(check.violation->at.actuator, 4);
  EXPECT_NEAR(check.violation->at.value, 0.31, 1e-9);
  EXPECT_EQ(check.violation->at.limit, 0.3);

  Reference bend = standing(lengths, Space::Actuator);  // 0.0006 m a step from rest at once: 0.06 m/s, but 6 m/s^2
  for (int k = 100; k < 200; ++k)
    bend.points(k, 0) += 0.0006 * std::min(k - 99, 20);
  check = checkReference(bend, robot);
  ASSERT_FALSE(check.ok());
  EXPECT_EQ(check.violation->at.quantity, Quantity::Acceleration);
  EXPECT_EQ(check.violation->at.line, 100);
  EXPECT_EQ(check.violation->at.actuator, 1);
  EXPECT_NEAR(check.violation->at.value, 6.0, 1e-9);
}

TEST(ReferenceCheck, CountsTheStartAndTheEndAsRest) {
  const mechanism::Robot robot = testRobot();
  Reference reference = standing(mechanism::legLengths(*robot.mechanism, kStart), Space::Actuator, 10);
  for (int k = 0; k < 10; ++k)
    reference.points(k, 2) += 0.0006 * k;  // constant speed, no bend inside
  const ReferenceCheck check = checkReference(reference, robot);
  ASSERT_FALSE(check.ok());
  EXPECT_EQ(check.violation->at.quantity, Quantity::Acceleration);
  EXPECT_EQ(check.violation->at.line, 1);
}

TEST(ReferenceCheck, AcceptsWhatIsExactlyAtALimit) {
  mechanism::Robot robot = testRobot();
  const mechanism::Lengths lengths = mechanism::legLengths(*robot.mechanism, kStart);
  for (int i = 0; i < 4; ++i)
    robot.actuators[i].position_min_m = lengths[i];
  EXPECT_EQ(verdict(standing(lengths, Space::Actuator), robot), "");
  robot.actuators[1].position_min_m += 1e-6;
  EXPECT_NE(verdict(standing(lengths, Space::Actuator), robot), "");
}

TEST(ReferenceCheck, NamesTheJointThatIsBentTooFar) {
  mechanism::Robot robot = testRobot();
  const Reference reference = moving(2, 0.2);
  const double spherical = mechanism::jointAngles(*robot.mechanism, reference.points.row(200).transpose()).platform[0];
  robot.joints.spherical_max = spherical - 0.01;
  ReferenceCheck check = checkReference(reference, robot);
  ASSERT_FALSE(check.ok());
  EXPECT_EQ(check.violation->at.quantity, Quantity::PlatformAngle);
  EXPECT_NE(check.violation->sentence.find("the spherical joint of leg"), std::string::npos)
      << check.violation->sentence;
  robot = testRobot();
  robot.joints.revolute_max = 0.1;
  EXPECT_NE(verdict(reference, robot).find("file.txt:1: the revolute joint of leg 4 is bent by"), std::string::npos);
}

TEST(ReferenceCheck, RefusesAPathInsideTheSingularityMargin) {
  mechanism::Robot robot = testRobot();
  const Reference reference = moving(2, -0.35);
  const double at_start = mechanism::conditionNumber(*robot.mechanism, kStart);
  const double at_end = mechanism::conditionNumber(*robot.mechanism, reference.points.row(200).transpose());
  ASSERT_GT(at_end, at_start + 5.0);
  robot.singularity_condition_max = 0.5 * (at_start + at_end);
  const ReferenceCheck check = checkReference(reference, robot);
  ASSERT_FALSE(check.ok());
  EXPECT_EQ(check.violation->at.quantity, Quantity::Condition);
  EXPECT_GT(check.violation->at.line, 1);
  EXPECT_LT(check.violation->at.line, 201);
  robot.singularity_condition_max = at_end + 1.0;
  EXPECT_EQ(verdict(reference, robot), "");
}

TEST(ReferenceCheck, RefusesAPathThroughASingularityEvenWithTheMarginWideOpen) {
  mechanism::Robot robot = testRobot();
  robot.singularity_condition_max = std::numeric_limits<double>::infinity();
  for (mechanism::Actuator& actuator : robot.actuators)
    actuator.position_min_m = 0.01;
  Reference reference = moving(2, -1.2);  // theta to -63 deg: through the singularity near -30 deg
  const auto determinant = [&](int k) {
    return mechanism::lengthJacobian(*robot.mechanism, reference.points.row(k).transpose()).determinant();
  };
  ASSERT_LT(determinant(0) * determinant(200), 0.0) << "this movement should cross a singularity";
  const ReferenceCheck check = checkReference(reference, robot);
  ASSERT_FALSE(check.ok());
  EXPECT_EQ(check.violation->at.quantity, Quantity::Assembly) << check.violation->sentence;
  EXPECT_TRUE(check.poses.rows() == 0);
}

TEST(ReferenceCheck, ChecksBenchAxesOneByOneWithoutAnyPose) {
  Reference reference = standing(mechanism::Vector4::Zero(), Space::Relative);
  for (int k = 0; k < 200; ++k)
    reference.points(k, 1) = 0.1 * (1.0 - std::cos(k * 3.14159265 / 200.0));
  EXPECT_EQ(verdict(reference, testBench(4)), "");
  EXPECT_EQ(verdict(reference, testBench(2)), "");
  EXPECT_TRUE(checkReference(reference, testBench(4)).poses.rows() == 0);
  EXPECT_THROW(checkReference(reference, testBench(1)), InputError);
  reference.points(100, 1) += 0.31;
  EXPECT_NE(verdict(reference, testBench(2)).find("file.txt:101: actuator 2"), std::string::npos);
  reference.space = Space::Platform;
  EXPECT_THROW(checkReference(reference, testBench(4)), InputError);
}

TEST(ReferenceCheck, RefusesAPeriodThatIsNotStreamed) {
  Reference reference = standing(kStart, Space::Platform);
  reference.period_s = 0.02;
  EXPECT_THROW(checkReference(reference, testRobot()), InputError);
}

}  // namespace
}  // namespace knee_robot::trajectory
