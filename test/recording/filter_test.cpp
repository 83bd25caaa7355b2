#include "knee_robot/recording/filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace knee_robot::recording {
namespace {

constexpr double kRate = 100.0;

Eigen::VectorXd sine(double hz, int n, double phase = 0.0) {
  Eigen::VectorXd x(n);
  for (int i = 0; i < n; ++i)
    x[i] = std::sin(2 * M_PI * hz * i / kRate + phase);
  return x;
}

/// Amplitude and phase of `hz` in the middle half of x.
std::pair<double, double> toneIn(const Eigen::VectorXd& x, double hz) {
  const Eigen::Index n = x.size() / 2, from = x.size() / 4;
  double s = 0, c = 0;
  for (Eigen::Index i = from; i < from + n; ++i) {
    s += x[i] * std::sin(2 * M_PI * hz * static_cast<double>(i) / kRate);
    c += x[i] * std::cos(2 * M_PI * hz * static_cast<double>(i) / kRate);
  }
  return {2 * std::hypot(s, c) / static_cast<double>(n), std::atan2(c, s)};
}

TEST(ZeroPhaseLowPass, HasTheGainOfTwoButterworthFiltersAndNoPhase) {
  const double cutoff = 3.0;
  for (const double hz : {0.5, 1.0, 2.0, 3.0, 5.0, 8.0}) {
    Eigen::VectorXd x = sine(hz, 8000);
    ZeroPhaseLowPass(cutoff, kRate).apply(x);
    const auto [gain, phase] = toneIn(x, hz);
    // Bilinear transform: |H|^2 of one pass is 1 / (1 + (tan(pi f/r) / tan(pi fc/r))^8), and the two passes square |H|.
    const double ratio = std::tan(M_PI * hz / kRate) / std::tan(M_PI * cutoff / kRate);
    EXPECT_NEAR(gain, 1.0 / (1.0 + std::pow(ratio, 8)), 2e-4) << hz;
    if (gain > 1e-3) {
      EXPECT_NEAR(phase, 0.0, 1e-3) << hz;
    }
  }
}

TEST(ZeroPhaseLowPass, PassesConstantsAndStraightLinesUpToTheEnds) {
  const Eigen::VectorXd line = Eigen::VectorXd::LinSpaced(500, -3.0, 7.0);
  Eigen::VectorXd x = line;
  ZeroPhaseLowPass(3.0, kRate).apply(x);
  EXPECT_LT((x - line).cwiseAbs().maxCoeff(), 1e-6);
  Eigen::VectorXd constant = Eigen::VectorXd::Constant(200, 12.5);
  ZeroPhaseLowPass(1.0, kRate).apply(constant);
  EXPECT_LT((constant.array() - 12.5).abs().maxCoeff(), 1e-9);
}

TEST(ZeroPhaseLowPass, PassesParabolasUpToTheEndsWhereItIsToldThatItIsAPosition) {
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(300, 0.0, 2.99);
  const Eigen::VectorXd parabola = 0.7 - 0.01 * t + 0.15 * t.square();
  Eigen::VectorXd x = parabola, as_line = parabola;
  ZeroPhaseLowPass(9.0, kRate, Continuation::Parabola).apply(x);
  ZeroPhaseLowPass(9.0, kRate).apply(as_line);
  // The filtered parabola lies higher by the same everywhere: its second difference times half the filter's spread.
  EXPECT_LT((x - parabola).maxCoeff() - (x - parabola).minCoeff(), 1e-7);
  EXPECT_NEAR(secondDerivative(x, 0.01)(0), 0.3, 1e-3);
  EXPECT_LT(std::abs(secondDerivative(as_line, 0.01)(0)), 0.15) << "a reflection at a point has no acceleration there";
}

TEST(ZeroPhaseLowPass, IsLinearAndTreatsTimeBothWaysAlike) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::VectorXd a(1000), b(1000);
  for (int i = 0; i < 1000; ++i) {
    a[i] = normal(random);
    b[i] = normal(random);
  }
  const ZeroPhaseLowPass filter(4.0, kRate);
  Eigen::VectorXd sum = 2.0 * a - 3.0 * b, fa = a, fb = b, turned = a.reverse();
  filter.apply(sum);
  filter.apply(fa);
  filter.apply(fb);
  filter.apply(turned);
  EXPECT_LT((sum - (2.0 * fa - 3.0 * fb)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((turned.reverse() - fa).segment(200, 600).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(ZeroPhaseLowPass, LeavesShortSignalsAndHighCutoffsAlone) {
  Eigen::VectorXd one = Eigen::VectorXd::Constant(1, 5.0);
  ZeroPhaseLowPass(3.0, kRate).apply(one);
  EXPECT_EQ(one[0], 5.0);
  Eigen::VectorXd few = sine(1.0, 10);
  ZeroPhaseLowPass(3.0, kRate).apply(few);
  EXPECT_TRUE(few.allFinite());
  const Eigen::VectorXd before = sine(30.0, 100);
  Eigen::VectorXd after = before;
  ZeroPhaseLowPass(46.0, kRate).apply(after);
  EXPECT_EQ(before, after);
}

TEST(Derivatives, AreExactForPolynomialsOfLowDegreeAndOfFourthOrderForSines) {
  const double h = 0.01;
  Eigen::MatrixXd x(300, 2);
  for (int i = 0; i < 300; ++i) {
    const double t = i * h;
    x(i, 0) = 2.0 + t - 0.5 * t * t + 0.3 * t * t * t;
    x(i, 1) = std::sin(2 * M_PI * 3.0 * t);
  }
  const Eigen::MatrixXd v = firstDerivative(x, h), a = secondDerivative(x, h);
  const double w = 2 * M_PI * 3.0;
  EXPECT_NEAR(v(0, 0), 1.0, 2e-4) << "also at the ends";
  EXPECT_NEAR(v(299, 0), 1.0 - 2.99 + 0.9 * 2.99 * 2.99, 2e-4);
  for (int i = 2; i < 298; ++i) {
    const double t = i * h;
    EXPECT_NEAR(v(i, 0), 1.0 - t + 0.9 * t * t, 1e-9);
    EXPECT_NEAR(a(i, 0), -1.0 + 1.8 * t, 1e-7);
    EXPECT_NEAR(v(i, 1), w * std::cos(w * t), 1e-4 * w);
    EXPECT_NEAR(a(i, 1), -w * w * std::sin(w * t), 1e-4 * w * w);
  }
  EXPECT_TRUE(v.allFinite());
  EXPECT_TRUE(a.allFinite());
}

}  // namespace
}  // namespace knee_robot::recording
