// Which law is taken where held-back blocks do not tell the best from a simpler one.
#include "src/identification/friction_simplest.h"

#include <gtest/gtest.h>

#include "src/identification/friction_families.h"

namespace knee_robot::identification {
namespace {

constexpr long kOneStop = 0, kPairOfTwo = 8, kSumOfMany = 9;
constexpr Worse kHalfAnError = {0.5, 1.0}, kTwoErrors = {2.0, 1.0}, kTenthOfAnError = {0.1, 1.0};

TEST(SimplestLaw, IsTakenForAPairWithinAQuarterOfAStandardError) {
  EXPECT_TRUE(inPlaceOf(kPairOfTwo, 2, kOneStop, kTenthOfAnError, 1.3));
  EXPECT_FALSE(inPlaceOf(kPairOfTwo, 2, kOneStop, kHalfAnError, 1.01));
  EXPECT_FALSE(inPlaceOf(kPairOfTwo, 2, kAllStops, kHalfAnError, 1.01)) << "a pair is simpler than all stops";
}

TEST(SimplestLaw, IsTakenForASpectrumWithinAWholeOneAndATenthOfWhatThatLeaves) {
  EXPECT_TRUE(inPlaceOf(kAllStops, 5, kOneStop, kHalfAnError, 1.05));
  EXPECT_FALSE(inPlaceOf(kAllStops, 5, kOneStop, kHalfAnError, 1.2));
  EXPECT_FALSE(inPlaceOf(kAllStops, 5, kOneStop, kTwoErrors, 1.05));
}

TEST(SpectrumOfStops, IsTakenForASumOfManyElementsAsNearAsThat) {
  EXPECT_TRUE(inPlaceOf(kSumOfMany, 4, kAllStops, kHalfAnError, 1.05));
  EXPECT_FALSE(inPlaceOf(kSumOfMany, 4, kAllStops, kHalfAnError, 1.2));
  EXPECT_FALSE(inPlaceOf(kSumOfMany, 4, kAllStops, kTwoErrors, 1.05));
  EXPECT_FALSE(inPlaceOf(kSumOfMany, 4, kOneStop, kHalfAnError, 1.05)) << "one stop has to be nearer";
}

}  // namespace
}  // namespace knee_robot::identification
