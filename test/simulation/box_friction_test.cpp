#include "knee_robot/simulation/box_friction.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace knee_robot::simulation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Case {
  mechanism::Matrix4 mobility;
  mechanism::Vector4 velocity;
  ImpulseBox box;
};

Case randomCase(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Case result;
  mechanism::Matrix4 root;
  for (int i = 0; i < 16; ++i)
    root(i / 4, i % 4) = normal(generator);
  result.mobility = root * root.transpose() + 1e-3 * mechanism::Matrix4::Identity();
  for (int axis = 0; axis < 4; ++axis) {
    result.velocity[axis] = normal(generator);
    const double bound = uniform(generator) < 0.2 ? 0.0 : uniform(generator);
    result.box.high[axis] = bound;
    result.box.low[axis] = -bound;
    if (uniform(generator) < 0.15) result.box.high[axis] = kInfinity;
    if (uniform(generator) < 0.15) result.box.low[axis] = -kInfinity;
  }
  return result;
}

/// Largest violation of: p in the box, and w > 0 only at the lower, w < 0 only at the upper bound.
double violation(const Case& problem, const mechanism::Vector4& impulses) {
  const mechanism::Vector4 result = problem.velocity + problem.mobility * impulses;
  double worst = 0.0;
  for (int axis = 0; axis < 4; ++axis) {
    worst = std::max({worst, impulses[axis] - problem.box.high[axis], problem.box.low[axis] - impulses[axis]});
    if (result[axis] > 0.0) worst = std::max(worst, std::min(result[axis], impulses[axis] - problem.box.low[axis]));
    if (result[axis] < 0.0) worst = std::max(worst, std::min(-result[axis], problem.box.high[axis] - impulses[axis]));
  }
  return worst;
}

TEST(BoxFriction, OpposesMotionOrStopsItInThousandsOfRandomCases) {
  std::mt19937 generator(1);
  double worst = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Case problem = randomCase(generator);
    AxisContacts contacts{};
    const mechanism::Vector4 impulses = solveBoxFriction(problem.mobility, problem.velocity, problem.box, contacts);
    worst = std::max(worst, violation(problem, impulses));
  }
  EXPECT_LT(worst, 1e-10);
}

TEST(BoxFriction, FindsTheSameImpulsesFromAnyGuess) {
  std::mt19937 generator(2);
  for (int i = 0; i < 300; ++i) {
    const Case problem = randomCase(generator);
    AxisContacts from_rest{};
    const mechanism::Vector4 expected = solveBoxFriction(problem.mobility, problem.velocity, problem.box, from_rest);
    for (const AxisContact guess : {AxisContact::AtLow, AxisContact::AtHigh}) {
      AxisContacts contacts;
      contacts.fill(guess);
      const mechanism::Vector4 impulses = solveBoxFriction(problem.mobility, problem.velocity, problem.box, contacts);
      EXPECT_LT((impulses - expected).norm(), 1e-9 * (1.0 + expected.norm()));
    }
  }
}

TEST(BoxFriction, GivesTheHandWorkedAnswerForIndependentAxes) {
  const mechanism::Matrix4 mobility = mechanism::Vector4(1.0, 1.0, 0.5, 2.0).asDiagonal();
  ImpulseBox box;
  box.high = mechanism::Vector4(1.0, 1.0, 1.0, 0.0);
  box.low = -box.high;
  AxisContacts contacts{};
  const mechanism::Vector4 impulses = solveBoxFriction(mobility, {0.4, -3.0, 0.4, 5.0}, box, contacts);
  EXPECT_NEAR(impulses[0], -0.4, 1e-15);  // stopped
  EXPECT_NEAR(impulses[1], 1.0, 1e-15);   // slowed down from -3 to -2
  EXPECT_NEAR(impulses[2], -0.8, 1e-15);  // stopped, half as mobile
  EXPECT_NEAR(impulses[3], 0.0, 1e-15);   // no friction
  EXPECT_EQ(contacts[0], AxisContact::Held);
  EXPECT_EQ(contacts[1], AxisContact::AtHigh);
}

}  // namespace
}  // namespace knee_robot::simulation
