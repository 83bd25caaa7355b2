// A movement near rest: small strokes of all sizes, by each actuator alone, with stops, within every limit.

#include "knee_robot/excitation/rest_excitation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "test/identification/chain_motion.h"
#include "test/trajectory/robots.h"

namespace knee_robot::excitation {
namespace {

const RestExcitation& planOf(const std::string& name) {
  static std::map<std::string, RestExcitation> plans;
  if (plans.count(name) == 0) plans[name] = planRestExcitation(trajectory::configuredRobot(name));
  return plans[name];
}

/// Ways between standing still and standing still again, m, with their sign.
std::vector<double> strokesOf(const trajectory::Points& points, int axis) {
  std::vector<double> out;
  double way = 0.0;
  for (Eigen::Index n = 1; n < points.rows(); ++n) {
    const double step = points(n, axis) - points(n - 1, axis);
    if (step == 0.0 && way != 0.0) {
      out.push_back(way);
      way = 0.0;
    }
    way += step;
  }
  return out;
}

class RestExcitationOf : public testing::TestWithParam<const char*> {};

TEST_P(RestExcitationOf, KeepsEveryLimitFromRestToRest) {
  mechanism::Robot robot = trajectory::configuredRobot(GetParam());
  robot.singularity_condition_max = trajectory::planningCondition(robot);
  const trajectory::Reference& reference = planOf(GetParam()).reference;
  const trajectory::ReferenceCheck check = trajectory::checkReference(reference, robot);
  ASSERT_TRUE(check.ok()) << check.violation->sentence;
  EXPECT_NEAR(static_cast<double>(reference.points.rows()), 9000.0, 10.0) << "90 s";
  for (const Eigen::Index n : {Eigen::Index{1}, reference.points.rows() - 1})
    EXPECT_EQ((reference.points.row(n) - reference.points.row(n - 1)).norm(), 0.0);
}

TEST_P(RestExcitationOf, MovesEveryActuatorByWaysOfAllSizesInBothDirections) {
  for (int i = 0; i < 4; ++i) {
    int small = 0, middle = 0, large = 0, back = 0;
    const std::vector<double> strokes = strokesOf(planOf(GetParam()).reference.points, i);
    for (const double way : strokes) {
      const double size = std::abs(way);
      ++(size < 2e-4 ? small : size < 1e-3 ? middle : large);
      back += way < 0.0 ? 1 : 0;
    }
    const std::string actuator = "actuator " + std::to_string(i + 1);
    EXPECT_GE(small, 5) << actuator;
    EXPECT_GE(middle, 3) << actuator;
    EXPECT_GE(large, 5) << actuator;
    EXPECT_NEAR(back, 0.5 * static_cast<double>(strokes.size()), 0.25 * static_cast<double>(strokes.size()))
        << actuator;
  }
}

TEST_P(RestExcitationOf, LetsEveryActuatorStandStillWhileOthersMove) {
  const trajectory::Points& points = planOf(GetParam()).reference.points;
  for (int i = 0; i < 4; ++i) {
    int stands = 0;
    for (Eigen::Index n = 1; n < points.rows(); ++n) {
      const mechanism::Vector4 step = points.row(n) - points.row(n - 1);
      if (step[i] == 0.0 && step.norm() > 0.0) ++stands;
    }
    EXPECT_GT(stands, 1500) << "15 s, actuator " << i + 1;
  }
}

TEST_P(RestExcitationOf, GoesToPlacesWithOtherLoads) {
  const mechanism::Robot robot = trajectory::configuredRobot(GetParam());
  const dynamics::RigidModel model(*robot.mechanism, robot.gravity, dynamics::loadRobotInertia(robot));
  const RestExcitation& plan = planOf(GetParam());
  ASSERT_EQ(plan.places.rows(), 4);
  mechanism::Vector4 least = mechanism::Vector4::Constant(1e9), most = -least;
  for (Eigen::Index n = 0; n < plan.check.poses.rows(); n += 50) {
    mechanism::Motion still;
    still.pose = plan.check.poses.row(n).transpose();
    mechanism::Vector4 forces;
    ASSERT_TRUE(dynamics::inverseDynamics(model, still, forces));
    least = least.cwiseMin(forces);
    most = most.cwiseMax(forces);
  }
  EXPECT_GT((most - least).minCoeff(), 5.0) << "N, of each actuator";
}

INSTANTIATE_TEST_SUITE_P(Robots, RestExcitationOf, testing::Values("A", "B", "final"));

TEST(RestExcitation, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const mechanism::Robot robot = trajectory::configuredRobot("A");
  RestExcitationOptions options;
  EXPECT_EQ(planRestExcitation(robot, options).reference.points, planOf("A").reference.points);
  options.seed = 2;
  EXPECT_NE(planRestExcitation(robot, options).reference.points, planOf("A").reference.points);
}

TEST(RestExcitation, KeepsTheRobotFilesMarginWhateverIsAskedFor) {
  mechanism::Robot robot = trajectory::configuredRobot("final");
  double widest = 0.0;
  for (const trajectory::Margin& m : planOf("final").check.margins)
    if (m.quantity == trajectory::Quantity::Condition) widest = m.value;
  robot.singularity_condition_max = 0.8 * widest;
  RestExcitationOptions options;
  options.condition_max = 1e6;
  EXPECT_TRUE(trajectory::checkReference(planRestExcitation(robot, options).reference, robot).ok());
}

TEST(RestExcitation, ServesABenchOfSeparateAxes) {
  mechanism::Robot bench;
  bench.path = "bench.yaml";
  bench.kind = mechanism::MechanismKind::Axes;
  mechanism::Actuator axis;
  axis.position_max_m = 0.4;
  axis.velocity_max_m_per_s = 1.0;
  axis.acceleration_max_m_per_s2 = 10.0;
  bench.actuators = {axis, axis};
  const RestExcitation plan = planRestExcitation(bench);
  EXPECT_TRUE(trajectory::checkReference(plan.reference, bench).ok());
  EXPECT_GT(plan.strokes, 20 * bench.axes());
}

TEST(RestExcitation, RefusesWhatItCannotPlanAndSaysHowToMendIt) {
  RestExcitationOptions options;
  EXPECT_THROW(planRestExcitation(identification::testArm()), InputError);
  options.condition_max = 0.5;
  EXPECT_THROW(planRestExcitation(trajectory::configuredRobot("A"), options), InputError);
  options.condition_max.reset();
  options.duration_s = 12.0;
  try {
    planRestExcitation(trajectory::configuredRobot("A"), options);
    ADD_FAILURE() << "12 s are too short for four places";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("plan a longer movement, or fewer places"), std::string::npos)
        << refusal.what();
  }
  mechanism::Robot narrow = trajectory::configuredRobot("A");
  for (mechanism::Actuator& a : narrow.actuators)
    a.position_max_m = a.position_min_m + 0.01;
  EXPECT_THROW(planRestExcitation(narrow), Refusal);
}

}  // namespace
}  // namespace knee_robot::excitation
