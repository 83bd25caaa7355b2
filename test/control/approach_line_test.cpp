#include "src/control/approach_line.h"

#include <gtest/gtest.h>

#include "fake_machine.h"

namespace knee_robot::control {
namespace {

constexpr double dt = trajectory::kStreamPeriod;

TEST(ApproachLines, GoFromRestToRestWithoutEverBeingFasterThanAsked) {
  const AxisValues from{0.6, 0.6, 0.6, 0.6}, to{0.7, 0.65, 0.6, 0.55};
  const trajectory::Points line = approachLine(from, to, fake::robot(), 0.02);
  const Eigen::Index last = line.rows() - 1;
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ(line(0, i), from[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(line(last, i), to[static_cast<std::size_t>(i)], 1e-15);
  }
  const trajectory::Points steps = line.bottomRows(last) - line.topRows(last);
  EXPECT_LE(steps.cwiseAbs().maxCoeff(), 0.02 * dt * (1.0 + 1e-9));
  EXPECT_GT(steps.cwiseAbs().maxCoeff(), 0.019 * dt);
  EXPECT_LT(steps.row(0).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(steps.row(last - 1).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(ApproachLines, KeepToHalfOfTheAccelerationLimit) {
  mechanism::Robot robot = fake::robot();
  for (mechanism::Actuator& actuator : robot.actuators)
    actuator.acceleration_max_m_per_s2 = 0.1;
  const trajectory::Points line = approachLine({0.6, 0.6, 0.6, 0.6}, {0.61, 0.6, 0.6, 0.6}, robot, 1.0);
  double highest = 0.0;
  for (Eigen::Index k = 1; k + 1 < line.rows(); ++k)
    highest = std::max(highest, std::abs(line(k + 1, 0) - 2.0 * line(k, 0) + line(k - 1, 0)) / (dt * dt));
  EXPECT_LE(highest, 0.05 * 1.01);
  EXPECT_GT(highest, 0.045);
}

TEST(ApproachLines, TakeHalfASecondWhereThereIsNothingToDo) {
  const AxisValues here{0.6, 0.6, 0.6, 0.6};
  EXPECT_EQ(approachLine(here, here, fake::robot(), 0.01).rows(), 51);
}

}  // namespace
}  // namespace knee_robot::control
