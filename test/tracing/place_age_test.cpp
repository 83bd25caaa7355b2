// How long ago an actuator was last where it is now.
#include "src/tracing/place_age.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using knee_robot::tracing::kOldest_s;
using knee_robot::tracing::placeAge;

constexpr double kPeriod_s = 0.01;

/// There and back over 100 mm, 5 s each way, so often.
Eigen::VectorXd thereAndBack(int times) {
  Eigen::VectorXd position(1000 * times);
  for (Eigen::Index n = 0; n < position.size(); ++n)
    position[n] = 0.5 + 1e-4 * (0.2 + 0.998 * std::abs(static_cast<double>((n + 500) % 1000) - 500.0) * 2.0);
  return position;
}

TEST(PlaceAge, IsTheOldestWhereTheActuatorHasNotBeen) {
  const Eigen::VectorXd age = placeAge(thereAndBack(1).head(500), kPeriod_s);
  EXPECT_EQ(age.minCoeff(), kOldest_s);
}

TEST(PlaceAge, IsTheTimeSinceAPlaceWasLeft) {
  const Eigen::VectorXd age = placeAge(thereAndBack(2), kPeriod_s);
  // Turned at 5 s; 2 s later it is where it was 2 s before that.
  EXPECT_NEAR(age[700], 4.0, 0.1);
  EXPECT_NEAR(age[510], 0.2, 0.1);
  // And on the way there again, turned at 10 s.
  EXPECT_NEAR(age[1300], 6.0, 0.1);
}

TEST(PlaceAge, StaysWhatItWasWhileTheActuatorRests) {
  Eigen::VectorXd position(2000);
  position.head(1000) = thereAndBack(1);
  position.tail(1000).setConstant(position[999]);
  const Eigen::VectorXd age = placeAge(position, kPeriod_s);
  EXPECT_EQ(age.tail(1000).minCoeff(), age.tail(1000).maxCoeff());
}

TEST(PlaceAge, StaysWhatItWasWhileAnEncoderFlickersOnTheBorderOfTwoPlaces) {
  Eigen::VectorXd position(2000);
  position.head(1000) = thereAndBack(1);
  const double border_m = position.minCoeff() + 0.020;
  for (Eigen::Index n = 1000; n < 2000; ++n)  // goes there from the end of the first way, and rests
    position[n] = n < 1200 ? position[999] + (border_m - position[999]) * static_cast<double>(n - 999) / 201.0
                           : border_m + (n % 2 == 0 ? 5e-6 : -5e-6);
  const Eigen::VectorXd age = placeAge(position, kPeriod_s);
  EXPECT_EQ(age.tail(790).minCoeff(), age.tail(790).maxCoeff());
  EXPECT_NEAR(age[1500], 2.9, 0.1);  // passed at 9 s on the way back, come to at 12 s, but for the width of the place
}

TEST(PlaceAge, CountsPlacesThatAFastAxisPassesBetweenTwoSamples) {
  Eigen::VectorXd position(4);
  position << 0.500, 0.540, 0.580, 0.520;  // 0.520 was passed when it went to 0.540
  EXPECT_NEAR(placeAge(position, 1.0)[3], 2.0, 1e-12);
}

TEST(PlaceAge, OfNothingIsNothing) {
  EXPECT_EQ(placeAge(Eigen::VectorXd(), kPeriod_s).size(), 0);
}

}  // namespace
