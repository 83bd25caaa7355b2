#include "knee_robot/dynamics/stroke_place.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using knee_robot::dynamics::StrokePlace;

TEST(StrokePlace, IsABellOverWhatTrainingHasSeen) {
  const StrokePlace place(0.7, 0.04, 0.5, 0.9);
  EXPECT_NEAR(place.at(0.7), 1.0, 1e-12);
  EXPECT_NEAR(place.at(0.74), std::exp(-1.0), 1e-12);
  EXPECT_NEAR(place.at(0.5), std::exp(-25.0), 1e-12);
}

TEST(StrokePlace, GoesBackToTheMeanBeyondTheRangeWithinItsOwnWidth) {
  // Half a bell, cut off at its top: the mean over 0.5 to 0.7 is sqrt(pi) / 2 * 0.04 / 0.2.
  const StrokePlace place(0.7, 0.04, 0.5, 0.7);
  const double mean = 0.5 * std::sqrt(M_PI) * 0.04 / 0.2;
  EXPECT_NEAR(place.at(0.7), 1.0, 1e-12);
  EXPECT_NEAR(place.at(0.71), mean + (1.0 - mean) * std::exp(-1.0 / 16.0), 1e-9);
  EXPECT_NEAR(place.at(0.9), mean, 1e-9);
}

TEST(StrokePlace, GoesOnWithTheBellWhereItsTopWasSeenAndItFallsAtTheEnd) {
  const StrokePlace place(0.7, 0.04, 0.65, 0.73);  // exp(-1.56) at the lower end, exp(-0.56) at the upper one
  EXPECT_NEAR(place.at(0.63), std::exp(-std::pow(0.07 / 0.04, 2)), 1e-12);
  EXPECT_NEAR(place.at(0.60), std::exp(-std::pow(0.10 / 0.04, 2)), 1e-12);
  EXPECT_NEAR(place.at(0.80), std::exp(-std::pow(0.10 / 0.04, 2)), 1e-12);
}

TEST(StrokePlace, IsContinuousAtTheEndsOfWhatTrainingHasSeen) {
  for (const double center_m : {0.62, 0.66, 0.72, 0.76}) {
    const StrokePlace place(center_m, 0.05, 0.65, 0.73);
    for (const double end_m : {0.65, 0.73})
      EXPECT_NEAR(place.at(end_m - 1e-9), place.at(end_m + 1e-9), 1e-6) << center_m;
  }
}

TEST(StrokePlace, LeavesATrendAlongTheStrokeAsItWasAtTheEnd) {
  const StrokePlace place(1.0, 0.5, 0.5, 0.7);
  EXPECT_NEAR(place.at(0.75), place.at(0.7), 0.005);
}

TEST(StrokePlace, TakesARangeOfNoLengthAsOnePosition) {
  const StrokePlace place(0.7, 0.04, 0.72, 0.71);
  EXPECT_NEAR(place.at(0.1), std::exp(-0.25), 1e-12);
  EXPECT_NEAR(place.at(0.72), std::exp(-0.25), 1e-12);
}

}  // namespace
