#include "src/identification/bootstrap.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <iostream>
#include <random>

namespace knee_robot::identification {
namespace {

/// One actuator, one hundred samples a second, three regressors that change slowly, noise with correlation `phi` from
/// sample to sample and unit variance; the truth is (2, -1, 0.5).
Equations correlated(int rows, double phi, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Equations e;
  e.axes = 1;
  e.blocks = 1;
  e.step_s = 0.01;
  e.duration_s = 0.01 * rows;
  e.a.resize(rows, 3);
  e.b.resize(rows);
  double noise = normal(random);
  for (int n = 0; n < rows; ++n) {
    const double t = 0.01 * n;
    e.a.row(n) << 1.0, std::sin(1.3 * t), std::cos(0.7 * t);
    e.b[n] = 2.0 - std::sin(1.3 * t) + 0.5 * std::cos(0.7 * t) + noise;
    noise = phi * noise + std::sqrt(1.0 - phi * phi) * normal(random);
    e.actuator.push_back(0);
    e.block.push_back(0);
    e.time_s.push_back(t);
    e.elapsed_s.push_back(t);
  }
  return e;
}

TEST(BootstrapBlock, GrowsWithTheResidualsMemory) {
  const auto length = [](double phi) {
    const Equations e = correlated(6000, phi, 3);
    const Eigen::VectorXd z = e.a.householderQr().solve(e.b);
    return bootstrapBlock_s(e, e.b - e.a * z);
  };
  const double none = length(0.0), some = length(0.9), much = length(0.98);
  std::cout << "blocks of " << none << ", " << some << ", " << much << " s\n";
  EXPECT_LE(none, 0.1);
  EXPECT_GT(some, 2.0 * none);
  EXPECT_GT(much, some);
}

TEST(BlockBootstrap, CoversTheTruthWhereResidualsAreCorrelated) {
  int inside = 0, inside_if_independent = 0, count = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Equations e = correlated(4000, 0.95, 100 + seed);
    const Eigen::VectorXd z = e.a.householderQr().solve(e.b);
    const Eigen::VectorXd residual = e.b - e.a * z;
    const Eigen::MatrixXd covariance =
        blockBootstrap(e, e.a, e.b, 0, bootstrapBlock_s(e, residual), 150, seed).covariance();
    const Eigen::MatrixXd independent =
        (e.a.transpose() * e.a).inverse() * residual.squaredNorm() / static_cast<double>(e.rows() - 3);
    const Eigen::Vector3d truth(2.0, -1.0, 0.5);
    for (int i = 0; i < 3; ++i, ++count) {
      inside += std::abs(z[i] - truth[i]) < 2.0 * std::sqrt(covariance(i, i));
      inside_if_independent += std::abs(z[i] - truth[i]) < 2.0 * std::sqrt(independent(i, i));
    }
  }
  std::cout << "two standard errors hold the truth in " << inside << " of " << count
            << " cases; as if samples were independent in " << inside_if_independent << "\n";
  EXPECT_GT(inside, 0.85 * count);
  EXPECT_LT(inside_if_independent, 0.6 * count);
}

TEST(BlockBootstrap, KeepsBoundsAndRepeatsWithItsSeed) {
  const Equations e = correlated(2000, 0.5, 9);
  const Bootstrap first = blockBootstrap(e, -e.a, e.b, 1, 0.5, 50, 4);
  const Bootstrap again = blockBootstrap(e, -e.a, e.b, 1, 0.5, 50, 4);
  EXPECT_EQ(first.draws, again.draws);
  EXPECT_EQ(first.draws.row(0).minCoeff(), 0.0) << "-2 is wanted, the bound is 0";
  EXPECT_EQ(first.draws.row(0).maxCoeff(), 0.0);
  EXPECT_EQ(first.blocks, 40);
}

}  // namespace
}  // namespace knee_robot::identification
