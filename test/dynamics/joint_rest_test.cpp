// How dry friction of the joints without motors builds up near rest, beside what is worked out by hand.
#include <gtest/gtest.h>

#include "knee_robot/dynamics/passive_joints.h"
#include "test/dynamics/random_robots.h"

namespace knee_robot::dynamics {
namespace {

constexpr double kCyclePeriod_s = 0.001;
constexpr double kBend_rad = 0.004;

/// Leg 4's revolute joint turning at `rate` for `cycles`: the share of its Coulomb friction at the end.
double shareAfter(double rate, int cycles, JointMemory& memory, const JointRestLaw& rest) {
  PassiveJoints joints{};
  joints.revolute = mechanism::Vector4::UnitZ();
  PoseColumns columns;
  memory.pose_velocity = mechanism::Vector4(0.0, 0.0, rate, 0.0);  // at this rate before, too
  for (int k = 0; k < cycles; ++k)
    baseJointColumns(joints, mechanism::Vector4(0.0, 0.0, rate, 0.0), rest, kCyclePeriod_s, memory, columns);
  return columns(2, 0);
}

TEST(JointBristles, BendOverTheirAngleWhateverTheSpeed) {
  const JointRestLaw rest{0.01, kBend_rad};
  JointMemory slow{}, fast{};
  EXPECT_NEAR(shareAfter(0.04, 100, slow, rest), 1.0 - std::exp(-1.0), 1e-12);  // 4 mrad
  EXPECT_NEAR(shareAfter(0.4, 10, fast, rest), 1.0 - std::exp(-1.0), 1e-12);
  EXPECT_NEAR(shareAfter(0.4, 100, fast, rest), 1.0, 1e-4);
}

TEST(JointBristles, KeepTheirForceAtRestAndTurnRoundOverTwiceTheWay) {
  const JointRestLaw rest{0.01, kBend_rad};
  JointMemory memory{};
  EXPECT_NEAR(shareAfter(0.4, 1000, memory, rest), 1.0, 1e-12);
  EXPECT_NEAR(shareAfter(0.0, 1000, memory, rest), 1.0, 1e-12) << "a joint at rest lets go of nothing";
  EXPECT_NEAR(shareAfter(-0.4, 10, memory, rest), -1.0 + 2.0 * std::exp(-1.0), 1e-12);
}

TEST(JointBristles, AreNoneWhereTheLawIsSmooth) {
  JointMemory memory{};
  EXPECT_NEAR(shareAfter(0.01, 1, memory, {0.01, 0.0}), 1.0 / std::sqrt(2.0), 1e-12);
  EXPECT_EQ(shareAfter(0.0, 1, memory, {0.01, 0.0}), 0.0);
  EXPECT_EQ(memory.bent, JointMemory{}.bent);
}

TEST(JointBristles, OfSphericalJointsBendAlongTheAxisOfTheTurn) {
  mechanism::RandomPoses random(5);
  const mechanism::Mechanism m = mechanism::finalMechanism();
  const mechanism::Motion motion = randomMotion(random, m);
  PassiveJoints joints;
  passiveJoints(m, motion, joints);
  JointMemory memory{};
  PoseColumns bent, smooth;
  for (int k = 0; k < 50'000; ++k)
    platformJointColumns(joints, motion.pose_velocity, {0.0, kBend_rad}, kCyclePeriod_s, memory, bent);
  JointMemory none{};
  platformJointColumns(joints, motion.pose_velocity, {0.0, 0.0}, kCyclePeriod_s, none, smooth);
  EXPECT_LT((bent - smooth).leftCols<kPlatformJointColumns>().norm(), 1e-9)
      << "after a long turn one way both are full Coulomb friction";
}

}  // namespace
}  // namespace knee_robot::dynamics
