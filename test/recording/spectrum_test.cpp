#include "knee_robot/recording/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace knee_robot::recording {
namespace {

TEST(PowerSpectrum, OfWhiteNoiseIntegratesToItsVariance) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 2.0);
  Eigen::VectorXd x(20000);
  for (double& value : x)
    value = normal(random);
  const Spectrum s = powerSpectrum(x, 100.0, 4.0);
  double power = 0.0;
  for (const double d : s.density)
    power += d * d * 0.25;
  EXPECT_NEAR(std::sqrt(power), 2.0, 0.05);
  EXPECT_NEAR(s.frequency_hz.back(), 50.0, 1e-9);
}

TEST(PowerSpectrum, ShowsASineAtItsFrequency) {
  Eigen::VectorXd x(3000);
  for (int n = 0; n < 3000; ++n)
    x[n] = std::sin(2 * M_PI * 7.0 * n / 100.0);
  const Spectrum s = powerSpectrum(x, 100.0, 4.0);
  const auto peak = std::max_element(s.density.begin(), s.density.end()) - s.density.begin();
  EXPECT_NEAR(s.frequency_hz[static_cast<std::size_t>(peak)], 7.0, 0.13);
}

TEST(PowerSpectrum, LooksOnlyAtRunsThatAreUsed) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2000);
  std::vector<char> use(2000, 1);
  for (int n = 900; n < 1000; ++n) {
    x[n] = n % 2 ? 1e3 : -1e3;
    use[static_cast<std::size_t>(n)] = 0;
  }
  const Spectrum with = powerSpectrum(x, 100.0, 2.0, use);
  EXPECT_EQ(*std::max_element(with.density.begin(), with.density.end()), 0.0);
  const Spectrum all = powerSpectrum(x, 100.0, 2.0);
  EXPECT_GT(*std::max_element(all.density.begin(), all.density.end()), 1.0);
}

TEST(PowerSpectrum, IsEmptyForNothing) {
  EXPECT_TRUE(powerSpectrum(Eigen::VectorXd::Zero(5), 100.0, 1.0).density.empty());
}

}  // namespace
}  // namespace knee_robot::recording
