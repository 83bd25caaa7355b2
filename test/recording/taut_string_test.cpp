// The shortest line within a band, against what is worked out by hand.
#include "src/recording/taut_string.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace knee_robot::recording {
namespace {

TEST(TautString, StandsStillWhereValuesTrembleWithinTheBand) {
  Eigen::VectorXd y(6);
  y << 1.0, 2.0, 1.0, 2.0, 2.0, 1.0;
  EXPECT_LT((tautString(y, 1.0).array() - 1.0).abs().maxCoeff(), 1e-12);
}

TEST(TautString, BendsAtTheEdgeOfTheBandAlone) {
  // From 0 over the lower edge of 9 at the third value, then straight to the last one.
  Eigen::VectorXd y(5);
  y << 0.0, 5.0, 10.0, 10.0, 10.0;
  Eigen::VectorXd line(5);
  line << 0.0, 4.5, 9.0, 9.5, 10.0;
  EXPECT_LT((tautString(y, 1.0) - line).norm(), 1e-12) << tautString(y, 1.0).transpose();
}

TEST(TautString, StaysWithinTheBandIsShorterAndChangesNothingWithoutOne) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  Eigen::VectorXd y(2000);
  for (Eigen::Index k = 0; k < y.size(); ++k)
    y[k] = std::round(20.0 * std::sin(0.01 * static_cast<double>(k)) + 0.5 * normal(random));
  EXPECT_EQ((tautString(y, 0.0) - y).norm(), 0.0);
  const Eigen::VectorXd line = tautString(y, 1.5);
  EXPECT_LE((line - y).cwiseAbs().maxCoeff(), 1.5 + 1e-9);
  const auto way = [](const Eigen::VectorXd& x) { return (x.tail(x.size() - 1) - x.head(x.size() - 1)).lpNorm<1>(); };
  EXPECT_LT(way(line), 0.5 * way(y));
}

/// Where a string bends a little at every value, looking ahead from each of them would take their number squared.
TEST(TautString, FollowsALongSmoothCurveAtTheEdgeOfTheBand) {
  const Eigen::VectorXd y = Eigen::VectorXd::LinSpaced(1000000, 0.0, 1e3).cwiseSqrt();
  const Eigen::VectorXd line = tautString(y, 1.5);
  EXPECT_NEAR(line[500000], y[500000] - 1.5, 1e-9);
  EXPECT_LE((line - y).cwiseAbs().maxCoeff(), 1.5 + 1e-9);
}

TEST(TautString, OfTwoValuesOrFewerIsThem) {
  EXPECT_EQ(tautString(Eigen::VectorXd(), 1.0).size(), 0);
  EXPECT_EQ(tautString(Eigen::Vector2d(1.0, 9.0), 1.0), Eigen::VectorXd(Eigen::Vector2d(1.0, 9.0)));
}

}  // namespace
}  // namespace knee_robot::recording
