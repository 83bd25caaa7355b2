#include "knee_robot/identification/sliding_path.h"

#include <gtest/gtest.h>

#include <cmath>

namespace knee_robot::identification {
namespace {

constexpr double kPeriod = 0.01;
constexpr double kCount = 5e-6;

struct Sampled {
  Eigen::VectorXd position, velocity;
};

/// x(t) = amplitude sin(w t) with a wiggle on top.
Sampled sine(double amplitude, double w, double wiggle, int samples = 600) {
  Sampled s{Eigen::VectorXd(samples), Eigen::VectorXd(samples)};
  for (int n = 0; n < samples; ++n) {
    const double t = n * kPeriod;
    s.position[n] = amplitude * std::sin(w * t) + wiggle * std::sin(60.0 * t);
    s.velocity[n] = amplitude * w * std::cos(w * t) + 60.0 * wiggle * std::cos(60.0 * t);
  }
  return s;
}

int signChanges(const Eigen::VectorXd& share) {
  int changes = 0;
  for (Eigen::Index n = 1; n < share.size(); ++n)
    changes += (share[n] > 0.0) != (share[n - 1] > 0.0);
  return changes;
}

TEST(SlidingPath, ReversesAtTheExtremeItselfAndNotForAWiggle) {
  const double w = 1.7;
  for (const double wiggle : {0.0, 0.3 * kCount}) {
    const Sampled s = sine(1e-3, w, wiggle);
    const Eigen::VectorXd share = frictionShare(slidingPath(s.position, s.velocity, kPeriod, kCount), 1e-9);
    EXPECT_EQ(signChanges(share), 3) << "sin(1.7 t) turns three times in 6 s";
    for (int turn = 0; turn < 3; ++turn) {
      const double at = (M_PI / 2 + turn * M_PI) / w;
      const double last = turn % 2 == 0 ? 1.0 : -1.0;
      EXPECT_NEAR(share[static_cast<Eigen::Index>(at / kPeriod) - 4], last, 1e-9);
      EXPECT_NEAR(share[static_cast<Eigen::Index>(at / kPeriod) + 6], -last, 1e-9) << "no later than 50 ms";
    }
  }
}

TEST(SlidingPath, AveragesAReversalOverTheSamplesInterval) {
  const double w = 1.7;
  const Sampled s = sine(1e-3, w, 0.0);
  const Eigen::VectorXd share = frictionShare(slidingPath(s.position, s.velocity, kPeriod, kCount), 1e-12);
  // The sum over all samples is the time spent going up less that going down, whatever the grid: exact to a quarter of
  // it.
  double up = 0.0;
  for (int k = 0; k < 599 * 100; ++k)
    up += std::cos(w * (k + 0.5) * kPeriod / 100.0) > 0.0 ? 0.01 : -0.01;
  EXPECT_NEAR(share.sum() - 0.5 * (share[0] + share[599]), up, 3 * 2 * 0.25);
  EXPECT_LE(share.cwiseAbs().maxCoeff(), 1.0);
}

TEST(SlidingPath, FrictionOfTheVelocityIsNeitherEarlyNorLate) {
  const double w = 1.7, speed = 4e-4;
  const Sampled s = sine(1e-3, w, 0.0);
  const Eigen::VectorXd share =
      frictionShare(slidingPath(s.position, s.velocity, kPeriod, kCount), dynamics::smoothLaw(speed));
  double late_s = 0.0, steep = 0.0;  // by least squares over all samples
  for (int n = 2; n < 598; ++n) {
    double mean = 0.0, slope = 0.0;
    for (int k = 0; k < 100; ++k) {
      const double t = (n - 0.5 + (k + 0.5) / 100.0) * kPeriod, x = 1e-3 * w * std::cos(w * t) / speed;
      mean += std::tanh(x) / 100.0;
      slope -= (1.0 - std::tanh(x) * std::tanh(x)) * 1e-3 * w * w * std::sin(w * t) / speed / 100.0;
    }
    late_s -= (share[n] - mean) * slope;
    steep += slope * slope;
    EXPECT_NEAR(share[n], mean, 2e-4) << n;
  }
  EXPECT_LT(std::abs(late_s / steep), 1e-5) << "half a substep is 1.25 ms";
}

TEST(SlidingPath, TakesUpItsWidthAfterAReversal) {
  Sampled s{Eigen::VectorXd(400), Eigen::VectorXd(400)};
  for (int n = 0; n < 400; ++n) {  // up at 1 mm/s, then down
    s.position[n] = 1e-5 * (n < 200 ? n : 400 - n);
    s.velocity[n] = n < 200 ? 1e-3 : -1e-3;
  }
  const Eigen::VectorXd share = frictionShare(slidingPath(s.position, s.velocity, kPeriod, kCount), 1e-4);
  EXPECT_NEAR(share[199], 1.0, 1e-6);
  EXPECT_NEAR(share[210], 0.0, 0.03) << "after 100 um of 200";
  EXPECT_NEAR(share[225], -1.0, 1e-6);
}

TEST(SlidingPath, TakesADipBeforeTheFirstMovementForNone) {
  Sampled s{Eigen::VectorXd::Zero(100), Eigen::VectorXd::Zero(100)};
  for (int n = 0; n < 100; ++n) {
    const double t = (n - 20) * kPeriod;  // down by 0.3 um until 0.2 s, then up
    s.position[n] = (t < 0.0 ? 0.75e-5 : 1e-3) * t * t;
    s.velocity[n] = 2.0 * (t < 0.0 ? 0.75e-5 : 1e-3) * t;
  }
  const SlidingPath path = slidingPath(s.position, s.velocity, kPeriod, kCount);
  EXPECT_EQ(path.first_direction, 1);
  const Eigen::VectorXd share = frictionShare(path, 2e-5);
  EXPECT_GE(share.minCoeff(), 0.0);
  EXPECT_EQ(share[10], 0.0) << "wider than a count: nothing is known of it before it moves";
  EXPECT_NEAR(share[35], 1.0, 0.2) << "22 um after it started";
  EXPECT_EQ(frictionShare(path, 1e-9)[10], 0.0) << "it stands, and nothing is known";
  EXPECT_EQ(frictionShare(path, 1e-9)[35], 1.0) << "narrower: built up before the encoder shows it";
}

TEST(SlidingPath, HasNoDirectionWhereNothingMoves) {
  const Eigen::VectorXd rest = Eigen::VectorXd::Constant(50, 0.3), still = Eigen::VectorXd::Zero(50);
  const SlidingPath path = slidingPath(rest, still, kPeriod, kCount);
  EXPECT_EQ(path.first_direction, 0);
  EXPECT_EQ(frictionShare(path, 1e-6), still);
}

/// The same by following the path once with the load from its beginning, nothing kept.
double worstAgainstFollowing(const SlidingPath& path, const dynamics::FrictionElement& element) {
  const Eigen::VectorXd kept = elementShare(path, element), followed = frictionShare(path, dynamics::lawOf({element}));
  return (kept - followed).cwiseAbs().maxCoeff();
}

TEST(SlidingPath, IsFollowedAnewOnlyUntilItsLoadAtTheStartIsForgotten) {
  using dynamics::FrictionKind;
  Sampled s = sine(2e-3, 2.0, 0.0);
  s.position.head(100).setConstant(s.position[100]);  // it stands before it moves
  s.velocity.head(100).setZero();
  SlidingPath path = slidingPath(s.position, s.velocity, kPeriod, kCount);
  path.tremble = Eigen::VectorXd::Constant(600, 1e-5);
  const SlidingPath unloaded = path;
  for (const double load : {-0.7, 0.9, 0.0}) {
    path.loaded_at_start = load;
    for (const dynamics::FrictionElement& e :
         {dynamics::FrictionElement{FrictionKind::Stop, 1.0, 1e-4, 0.0, 0.0},
          dynamics::FrictionElement{FrictionKind::Stop, 1.0, 1.0, 0.0,
                                    0.0},  // wider than the whole way: never forgotten
          dynamics::FrictionElement{FrictionKind::Stop, 1.0, 6e-5, 0.0, 0.0, 0.0, 1.0, 5e-5},
          dynamics::FrictionElement{FrictionKind::Stop, 1.0, 1e-4, 0.0, 0.0, 0.0, 1.0, 0.0, 2.0},
          dynamics::FrictionElement{FrictionKind::Smooth, 1.0, 0.0, 1e-3},
          dynamics::FrictionElement{FrictionKind::Bristles, 1.0, 1e-4, 0.0, 0.01},
          dynamics::FrictionElement{FrictionKind::Bristles, 1.0, 5e-4, 2e-4, 0.0},
          dynamics::FrictionElement{FrictionKind::Bristles, 1.0, 1e-3, 0.0, 0.01, 1.0},
          dynamics::FrictionElement{FrictionKind::Bristles, 1.0, 1e-4, 0.0, 0.0, 0.0, 0.5},
          dynamics::FrictionElement{FrictionKind::Bristles, 1.0, 1e-4, 0.0, 0.0, 0.0, 2.0}}) {
      EXPECT_LT(worstAgainstFollowing(path, e), 1e-11) << "load " << load << " width " << e.width_m;
      EXPECT_LT(worstAgainstFollowing(unloaded, e), 1e-11) << "copies have in common what is kept";
    }
  }
}

}  // namespace
}  // namespace knee_robot::identification
