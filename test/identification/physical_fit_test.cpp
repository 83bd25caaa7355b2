#include "knee_robot/identification/physical_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/physical_problem.h"
#include "test/identification/observe_one.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

/// The inertias that syntheticModel has, each mass and length off by up to `wrong` (relative).
dynamics::RobotInertia syntheticPrior(const dynamics::Model& truth, double wrong, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-wrong, wrong);
  dynamics::RobotInertia prior;
  for (int link = 0; link < dynamics::kLinks; ++link) {
    dynamics::LinkParameters p;
    for (int k = 0; k < dynamics::kLinkParameters; ++k)
      p[k] = truth.parameters[static_cast<std::size_t>(link * dynamics::kLinkParameters + k)].value;
    dynamics::LinkInertia body = dynamics::fromParameters(p);
    const double mass = 1.0 + uniform(random), size = 1.0 + uniform(random);
    body.mass *= mass;
    body.center *= size;
    body.inertia *= mass * size * size;
    prior.links[static_cast<std::size_t>(link)] = body;
  }
  return prior;
}

Eigen::VectorXd inertialOf(const dynamics::Model& model) {
  Eigen::VectorXd values(dynamics::kInertialParameters);
  for (int i = 0; i < dynamics::kInertialParameters; ++i)
    values[i] = model.parameters[static_cast<std::size_t>(i)].value;
  return values;
}

TEST(PhysicalCoordinates, OneIsThePriorAndTheTransformIsLinear) {
  const dynamics::RobotInertia prior = syntheticPrior(syntheticModel(syntheticRobot()), 0.3, 1);
  const PhysicalCoordinates c = physicalCoordinates(prior);
  Eigen::VectorXd one = Eigen::VectorXd::Zero(90);
  for (int k = 0; k < 90; ++k)
    one[k] = k % 10 < 4 ? 1.0 : 0.0;
  EXPECT_LT((c.transform * one - c.prior).norm(), 1e-5 * c.prior.norm());
  EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(c.transform).rank(), 90);
}

/// Random data in which only some directions of the coordinates are seen.
PhysicalProblem randomProblem(const PhysicalCoordinates& c, int seen, const Eigen::VectorXd& truth, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  PhysicalProblem p;
  p.data.resize(seen, c.transform.cols());
  for (double& value : p.data.reshaped())
    value = 100.0 * normal(random);
  p.target = p.data * truth;
  return p;
}

TEST(SolvePhysical, ReproducesPossibleParametersThatTheDataDetermine) {
  const dynamics::Model truth = syntheticModel(syntheticRobot());
  const PhysicalCoordinates c = physicalCoordinates(syntheticPrior(truth, 0.3, 2));
  const Eigen::VectorXd coordinates = c.transform.fullPivLu().solve(inertialOf(truth));
  const PhysicalProblem p = randomProblem(c, 200, coordinates, 3);
  const PhysicalSolution s = solvePhysical(p, priorPull(p, 1e-3));
  EXPECT_LT((s.inertial - coordinates).norm(), 1e-5 * coordinates.norm());
}

TEST(SolvePhysical, LeavesThePriorWhereTheDataAreSilentAndFollowsTheDataWhereTheySpeak) {
  const PhysicalCoordinates c = physicalCoordinates(syntheticPrior(syntheticModel(syntheticRobot()), 0.0, 1));
  Eigen::VectorXd one = Eigen::VectorXd::Zero(90);
  for (int k = 0; k < 90; ++k)
    one[k] = k % 10 < 4 ? 1.0 : 0.0;
  PhysicalProblem p = randomProblem(c, 1, one, 4);
  p.data.setZero();
  p.data(0, 89 - 6) = 1e3;  // one diagonal element of one link's E is measured: 1.5 instead of 1
  p.target = Eigen::VectorXd::Constant(1, 1.5e3);
  const PriorPull pull = priorPull(p, 1.0);
  EXPECT_NEAR(pull.silent, 89.0, 1e-6);
  const PhysicalSolution s = solvePhysical(p, pull);
  one[89 - 6] = 1.5;
  EXPECT_LT((s.inertial - one).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(SolvePhysical, NeverLeavesThePossibleEvenWhereTheDataAskForIt) {
  const PhysicalCoordinates c = physicalCoordinates(syntheticPrior(syntheticModel(syntheticRobot()), 0.0, 1));
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, 3.0);
    Eigen::VectorXd impossible(90);
    for (double& value : impossible)
      value = normal(random);  // negative masses, negative moments
    const PhysicalProblem p = randomProblem(c, 150, impossible, seed);
    const PhysicalSolution s = solvePhysical(p, priorPull(p, 1.0));
    const Eigen::VectorXd inertial = c.transform * s.inertial;
    for (int link = 0; link < dynamics::kLinks; ++link) {
      const dynamics::LinkInertia body =
          dynamics::fromParameters(dynamics::LinkParameters(inertial.segment<10>(10 * link)));
      EXPECT_EQ(dynamics::inconsistency(body), "") << "seed " << seed << ", link " << link;
    }
    EXPECT_GT(s.cost, 1.0);
  }
}

/// A random possible set of bodies, in coordinates.
Eigen::VectorXd randomBodies(std::mt19937& random) {
  std::normal_distribution<double> normal(0.0, 2.0);
  Eigen::VectorXd z(90);
  for (int link = 0; link < 9; ++link) {
    Eigen::Matrix4d u;
    for (double& value : u.reshaped())
      value = normal(random);
    const Eigen::Matrix4d e = u * u.transpose();
    z.segment<4>(10 * link) = e.diagonal();
    int k = 4;
    for (int row = 0; row < 4; ++row) {
      for (int column = row + 1; column < 4; ++column)
        z[10 * link + k++] = M_SQRT2 * e(row, column);
    }
  }
  return z;
}

/// The problem is convex in the bodies: at its optimum no way to any possible set of bodies goes down. Targets so
/// impossible that most bodies end on the boundary, and a prior that hardly pulls.
TEST(SolvePhysical, EndsAtTheOptimumOnTheBoundaryToo) {
  const PhysicalCoordinates c = physicalCoordinates(syntheticPrior(syntheticModel(syntheticRobot()), 0.0, 1));
  int pushes = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(100 + seed);
    std::normal_distribution<double> normal(0.0, 3.0);
    Eigen::VectorXd impossible(90);
    for (double& value : impossible)
      value = normal(random);
    const PhysicalProblem p = randomProblem(c, 150, impossible, 100 + seed);
    const PriorPull pull = priorPull(p, 1e-2);
    const PhysicalSolution s = solvePhysical(p, pull);
    EXPECT_TRUE(s.optimal) << "seed " << seed;
    pushes += s.pushes;
    const Eigen::VectorXd slope = 2.0 * p.data.transpose() * (p.data * s.inertial - p.target) +
                                  2.0 * pull.root.transpose() * (pull.root * (s.inertial - pull.mean));
    for (int k = 0; k < 200; ++k) {
      const Eigen::VectorXd way = randomBodies(random) - s.inertial;
      const double curvature = (p.data * way).squaredNorm() + (pull.root * way).squaredNorm();
      const double down = std::max(0.0, -slope.dot(way));
      EXPECT_LT(down * down / (4.0 * curvature), 1e-4 * s.cost) << "gain along a straight way, seed " << seed;
    }
  }
  std::cout << pushes << " pushes off the boundary in 10 problems\n";
}

TEST(FitPhysical, PredictsAnotherTrajectoryWithPossibleBodiesFromAWrongPrior) {
  const mechanism::Robot robot = syntheticRobot();
  const dynamics::Model truth = syntheticModel(robot);
  std::mt19937 random(12);
  std::normal_distribution<double> normal(0.0, 0.5);
  const auto noise = [&] { return normal(random); };
  const IdentifyOptions options;
  auto train = observeOne(robot, syntheticRecording(robot, truth, 0, 40.0, noise), options);
  auto validate = observeOne(robot, syntheticRecording(robot, truth, 1, 30.0, noise), options);
  const Identification id = identify(robot, train, options);
  const dynamics::RobotInertia prior = syntheticPrior(truth, 0.4, 7);
  const PhysicalFit fit = fitPhysical(robot, id, prior);
  for (const dynamics::LinkInertia& body : fit.inertia.links)
    EXPECT_EQ(dynamics::inconsistency(body), "");
  const double cutoff = options.observation.cutoff_hz;
  const Accuracy physical = applyModel(fit.model, robot, validate, cutoff).accuracy;
  const Accuracy base = applyModel(id.model, robot, validate, cutoff).accuracy;
  dynamics::Model untouched = fit.model;  // the prior as it is, with the friction that was fitted
  const dynamics::InertialParameters given = dynamics::toParameters(prior);
  for (int i = 0; i < dynamics::kInertialParameters; ++i)
    untouched.parameters[static_cast<std::size_t>(i)].value = given[i];
  const Accuracy before = applyModel(untouched, robot, validate, cutoff).accuracy;
  std::cout << "strength " << fit.strength << ", supported " << fit.supported << ", moving, N: physical "
            << physical.rms_moving_N.transpose() << ", base " << base.rms_moving_N.transpose() << ", prior "
            << before.rms_moving_N.transpose() << "\n";
  EXPECT_LT(physical.rms_moving_N.maxCoeff(), 0.7);
  EXPECT_LT(physical.rms_moving_N.maxCoeff(), 0.2 * before.rms_moving_N.maxCoeff());
}

}  // namespace
}  // namespace knee_robot::identification
