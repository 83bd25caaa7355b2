#include "src/tracing/said_of_laws.h"

#include <gtest/gtest.h>

namespace knee_robot::tracing {
namespace {

identification::TriedLaw tried(const dynamics::FrictionLaw& law, double beyond_best, double standard_error) {
  identification::TriedLaw t;
  t.law = law;
  t.beyond_best = beyond_best;
  t.standard_error = standard_error;
  return t;
}

const dynamics::FrictionLaw kLong = dynamics::bristleLaw(7e-4), kStep = dynamics::stopLaw(2e-5);

TEST(LongPresliding, IsSaidWhereLawsWithoutItAreSurelyWorse) {
  const std::string text = longPresliding({{kStep, {tried(kStep, 0.0, 0.0), tried(kLong, 2.0, 0.1)}},
                                           {kLong, {tried(kStep, 1.3, 0.2), tried(kLong, 0.0, 0.0)}}});
  EXPECT_EQ(text.find("actuator 1"), std::string::npos) << text;
  EXPECT_NE(text.find("of actuator 2 (bristles 700 um)"), std::string::npos) << text;
}

TEST(LongPresliding, IsNotSaidWhereAnotherLawIsAboutAsGood) {
  EXPECT_EQ(longPresliding({{kLong, {tried(dynamics::smoothLaw(1e-3), 0.3, 0.2), tried(kLong, 0.0, 0.0)}}}), "");
}

TEST(LongPresliding, IsNotSaidOfASmallPartOfTheFriction) {
  const dynamics::FrictionLaw part =
      dynamics::lawOf({{dynamics::FrictionKind::Smooth, 0.8, 0.0, 1e-3}, {dynamics::FrictionKind::Stop, 0.2, 2e-3}});
  EXPECT_EQ(longPresliding({{part, {tried(kStep, 9.0, 0.1), tried(part, 0.0, 0.0)}}}), "");
}

TEST(LongPresliding, IsNotSaidOfLawsThatWereGivenRatherThanTried) {
  EXPECT_EQ(longPresliding({{kLong, {}}}), "");
}

TEST(PeakNearRest, IsSaidOfLawsThatTakeAwayFromWhatBuildsUp) {
  const dynamics::FrictionLaw peak = dynamics::lawOf(
      {{dynamics::FrictionKind::Bristles, 1.3, 8e-5}, {dynamics::FrictionKind::Smooth, -0.3, 0.0, 1e-3}});
  EXPECT_EQ(peakNearRest({{kStep, {tried(kStep, 0.0, 0.0)}}, {peak, {tried(peak, 0.0, 0.0)}}}),
            "dry friction is larger near rest than beyond, by up to 30 % on actuator 2 (bristles 80 um (130 %) + "
            "tanh(v / 1 mm/s) (-30 %))");
  EXPECT_EQ(peakNearRest({{kStep, {tried(kStep, 0.0, 0.0)}}, {peak, {}}}), "");
}

}  // namespace
}  // namespace knee_robot::tracing
