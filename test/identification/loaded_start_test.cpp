// What friction holds when recordings begin: usual where those of training agree on it.
#include "src/identification/loaded_start.h"

#include <gtest/gtest.h>

#include <optional>

namespace knee_robot::identification {
namespace {

constexpr double kStartPeriod_s = 0.01, kStartResolution_m = 2e-6;

/// Of one actuator, as findLoadedStart leaves them.
double usual(const std::vector<std::optional<double>>& starts) {
  std::vector<Observation> training(starts.size());
  for (std::size_t r = 0; r < starts.size(); ++r) {
    training[r].sliding.resize(1);
    training[r].sliding[0].loaded_at_start = starts[r];
  }
  return usualStart(training)[0];
}

TEST(UsualStart, IsTheMeanOfRecordingsThatAgreeAsFarAsTheirNumberMakesThatLikely) {
  EXPECT_DOUBLE_EQ(usual({0.5, 0.7}), 2.0 / 3.0 * 0.6);
  EXPECT_DOUBLE_EQ(usual({-0.5, -0.6, -0.4}), 3.0 / 4.0 * -0.5);
  EXPECT_DOUBLE_EQ(usual({0.5, std::nullopt, 0.7}), 2.0 / 3.0 * 0.6) << "an axis that moves at once tells nothing";
}

TEST(UsualStart, IsNotKnownFromOneRecordingNorFromThoseThatDoNotAgree) {
  EXPECT_EQ(usual({0.5}), 0.0);
  EXPECT_EQ(usual({0.5, std::nullopt}), 0.0);
  EXPECT_EQ(usual({0.5, -0.4}), 0.0);
  EXPECT_EQ(usual({0.5, 0.2}), 0.0) << "0.2 is nearer to nothing than to 0.5";
  EXPECT_EQ(usual({0.6, 0.5, 0.1}), 0.0);
}

TEST(UsualStart, OfNextToNothingIsNone) {
  EXPECT_EQ(usual({0.03, 0.04}), 0.0);
}

TEST(UsualStart, IsHeldByWhatRemembers) {
  EXPECT_EQ(ofThoseThatRemember(dynamics::stopLaw(1e-4), 0.4), 0.4);
  EXPECT_EQ(ofThoseThatRemember(dynamics::smoothLaw(1e-3), 0.4), 0.0);
  using dynamics::FrictionElement;
  using dynamics::FrictionKind;
  const auto half = dynamics::lawOf(
      {FrictionElement{FrictionKind::Stop, 0.5, 1e-4}, FrictionElement{FrictionKind::Smooth, 0.5, 0.0, 1e-3}});
  EXPECT_DOUBLE_EQ(ofThoseThatRemember(half, 0.4), 0.8);
  EXPECT_EQ(ofThoseThatRemember(half, -0.9), -1.0) << "no more than all of them";
}

/// At rest, then 2 mm at 10 mm/s, or on its way from the beginning.
SlidingPath pathThatRests(double rest_s) {
  constexpr int kSamples = 200;
  Eigen::VectorXd position(kSamples), velocity(kSamples);
  for (int n = 0; n < kSamples; ++n) {
    velocity[n] = kStartPeriod_s * n >= rest_s ? 0.01 : 0.0;
    position[n] = 0.01 * std::max(0.0, kStartPeriod_s * n - rest_s);
  }
  return slidingPath(position, velocity, kStartPeriod_s, kStartResolution_m);
}

TEST(FrictionAtStart, IsHeldUntilTheAxisMovesAndForgottenThen) {
  dynamics::FrictionLaw law = dynamics::stopLaw(1e-4);
  law.at_start = -0.6;
  const Eigen::VectorXd share = frictionShare(pathThatRests(1.0), law);
  EXPECT_NEAR(share[0], -0.6, 1e-9);
  EXPECT_NEAR(share[90], -0.6, 1e-9);
  EXPECT_NEAR(share[150], 1.0, 1e-9);
}

TEST(FrictionAtStart, IsNothingToAnAxisThatMovesAlready) {
  dynamics::FrictionLaw law = dynamics::stopLaw(1e-4);
  const Eigen::VectorXd without = frictionShare(pathThatRests(0.0), law);
  law.at_start = -0.6;
  EXPECT_EQ(frictionShare(pathThatRests(0.0), law), without);
}

TEST(FrictionAtStart, IsWhatARecordingItselfTellsWhereThatIsAsked) {
  dynamics::FrictionLaw law = dynamics::stopLaw(1e-4);
  law.at_start = -0.6;
  SlidingPath path = pathThatRests(1.0);
  path.loaded_at_start = 0.3;
  EXPECT_NEAR(frictionShare(path, law)[50], 0.3, 1e-9);
}

}  // namespace
}  // namespace knee_robot::identification
