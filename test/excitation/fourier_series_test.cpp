#include "knee_robot/excitation/fourier_series.h"

#include <gtest/gtest.h>

namespace knee_robot::excitation {
namespace {

FourierSeries anySeries() {
  FourierSeries series;
  series.shape = {5, 4.0, 1.5, 15.0};
  series.centre << 0.6, 0.7, 0.8, 0.9;
  std::srand(3);
  series.coefficients = Eigen::MatrixXd::Random(4, 10);
  return series;
}

SeriesPoint at(const FourierSeries& series, double time) {
  return pointAt(series, seriesBasis(series.shape, time));
}

TEST(FourierSeries, StartsAndEndsAtRestInItsCentre) {
  const FourierSeries series = anySeries();
  for (const double time : {0.0, 15.0}) {
    const SeriesPoint point = at(series, time);
    EXPECT_EQ(point.value, series.centre);
    EXPECT_EQ(point.rate.norm(), 0.0);
    EXPECT_EQ(point.acceleration.norm(), 0.0);
  }
}

TEST(FourierSeries, RepeatsItsPeriodBetweenTheRamps) {
  const FourierSeries series = anySeries();
  for (double time = 1.6; time < 9.4; time += 0.37) {
    EXPECT_LE((at(series, time).value - at(series, time + 4.0).value).norm(), 1e-12);
    EXPECT_LE((at(series, time).acceleration - at(series, time + 4.0).acceleration).norm(), 1e-10);
  }
}

TEST(FourierSeries, RatesAreTheDerivativesOfItsValuesRampsIncluded) {
  const FourierSeries series = anySeries();
  const double h = 1e-5;
  for (double time = 0.011; time < 14.99; time += 0.053) {
    const SeriesPoint before = at(series, time - h), here = at(series, time), after = at(series, time + h);
    EXPECT_LE(((after.value - before.value) / (2 * h) - here.rate).norm(), 1e-6);
    EXPECT_LE(((after.rate - before.rate) / (2 * h) - here.acceleration).norm(), 1e-5);
  }
}

TEST(FourierSeries, IsSampledEveryTenMillisecondsFromRestToRest) {
  const FourierSeries series = anySeries();
  const trajectory::Reference reference = sampledReference(series);
  ASSERT_EQ(reference.points.rows(), 1501);
  EXPECT_EQ(reference.points.row(0).transpose(), series.centre);
  EXPECT_LE((reference.points.row(1500).transpose() - series.centre).norm(), 1e-12);
  EXPECT_EQ(reference.points.row(700).transpose(), at(series, 7.0).value);
}

}  // namespace
}  // namespace knee_robot::excitation
