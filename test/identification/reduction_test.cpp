#include "knee_robot/identification/reduction.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <iostream>
#include <random>

#include "knee_robot/identification/prior_strength.h"

namespace knee_robot::identification {
namespace {

Eigen::MatrixXd randomMatrix(int rows, int columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd m(rows, columns);
  for (double& value : m.reshaped())
    value = normal(random);
  return m;
}

/// Two columns with a physical sign, four others of which one repeats another and one does not occur.
std::vector<Column> sixColumns() {
  return {{"Fv", "", ColumnRole::Viscous, 0}, {"r1", "", ColumnRole::Rigid, -1}, {"r2", "", ColumnRole::Rigid, -1},
          {"Fc", "", ColumnRole::Coulomb, 0}, {"r3", "", ColumnRole::Rigid, -1}, {"r4", "", ColumnRole::Rigid, -1}};
}

Eigen::MatrixXd sixColumnData(unsigned seed) {
  Eigen::MatrixXd a = randomMatrix(200, 6, seed);
  a.col(2) = -2.0 * a.col(1);
  a.col(5).setZero();
  a.col(3) *= 1e4;  // badly scaled
  return a;
}

/// Of no claim: every column without a sign is expected to be 0, and 1 is a usual size.
Prior unitPrior(const std::vector<Column>& columns) {
  Prior prior;
  const auto count = static_cast<Eigen::Index>(columns.size());
  prior.mean = Eigen::VectorXd::Zero(count);
  prior.transform = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    if (columns[static_cast<std::size_t>(c)].isNonNegative()) prior.transform(c, c) = 0.0;
  }
  return prior;
}

TEST(Compress, KeepsTheLeastSquaresProblem) {
  const Eigen::MatrixXd a = randomMatrix(500, 8, 1);
  const Eigen::VectorXd b = randomMatrix(500, 1, 2);
  const Eigen::MatrixXd t = compress(a, b);
  EXPECT_EQ(t.rows(), 9);
  const Eigen::VectorXd full = a.colPivHouseholderQr().solve(b);
  const Eigen::VectorXd small = t.leftCols(8).colPivHouseholderQr().solve(t.col(8));
  EXPECT_LT((full - small).norm(), 1e-10);
  EXPECT_NEAR((a * full - b).norm(), (t.leftCols(8) * full - t.col(8)).norm(), 1e-9);
}

TEST(Reduce, FindsTheRankLeavesOutWhatDoesNotOccurAndSolvesExactly) {
  const Eigen::MatrixXd a = sixColumnData(3);
  Eigen::VectorXd truth(6);
  truth << 2.0, 1.0, 0.5, 3e-4, -4.0, 100.0;
  const Reduction r = reduce(compress(a, a * truth), sixColumns(), std::vector<char>(6, 1), unitPrior(sixColumns()));
  EXPECT_EQ(r.minimalRank(), 2);
  EXPECT_EQ(r.maximalRank(), 4);  // two kept, r1 or r2, r3
  const Eigen::VectorXd p = toParameters(r, solveWithPrior(r, 4, 1e-12));
  EXPECT_LT((a * p - a * truth).norm(), 1e-8);
  EXPECT_NEAR(p[0], 2.0, 1e-9);
  EXPECT_NEAR(p[3], 3e-4, 1e-12);
  EXPECT_EQ(p[5], 0.0);
}

TEST(Reduce, LeavesOutColumnsThatAreNotUsed) {
  const Eigen::MatrixXd a = sixColumnData(4);
  const Reduction r = reduce(compress(a, a.col(1)), sixColumns(), {0, 1, 1, 0, 1, 1}, unitPrior(sixColumns()));
  EXPECT_EQ(r.minimalRank(), 0);
  EXPECT_EQ(r.maximalRank(), 2);
  EXPECT_EQ(toParameters(r, solveWithPrior(r, 2, 1e-12))[0], 0.0);
}

TEST(BoundedLeastSquares, SatisfiesTheOptimalityConditionsOnRandomProblems) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Eigen::MatrixXd x = randomMatrix(30, 8, seed) + Eigen::MatrixXd::Constant(30, 8, 0.5);
    const Eigen::VectorXd y = randomMatrix(30, 1, seed + 1000);
    const int bounded = 5;
    const Eigen::VectorXd z = boundedLeastSquares(x, y, bounded);
    const Eigen::VectorXd pull = x.transpose() * (y - x * z);
    for (int i = 0; i < 8; ++i) {
      if (i < bounded && z[i] == 0.0) {
        EXPECT_LE(pull[i], 1e-7) << "seed " << seed;
      } else {
        EXPECT_NEAR(pull[i], 0.0, 1e-7) << "seed " << seed;
      }
      if (i < bounded) {
        EXPECT_GE(z[i], 0.0);
      }
    }
  }
}

/// Orthogonal 16 x 16 matrix of elements +-1/4: mixes directions of different strength into columns of one size.
Eigen::MatrixXd hadamard() {
  Eigen::MatrixXd h = Eigen::MatrixXd::Constant(1, 1, 0.25);
  while (h.rows() < 16) {
    Eigen::MatrixXd next(2 * h.rows(), 2 * h.rows());
    next << h, h, h, -h;
    h = next;
  }
  return h;
}

/// Equations of ten blocks over 16 columns with directions of quickly falling strength, of which the first `alive`
/// matter.
Equations fallingEquations(int alive, double noise, unsigned seed) {
  Equations e;
  e.axes = 1;
  e.blocks = 10;
  const Eigen::MatrixXd directions = randomMatrix(600, 16, seed);
  Eigen::VectorXd strength(16);
  for (int i = 0; i < 16; ++i)
    strength[i] = std::pow(0.5, i);
  e.a = directions * strength.asDiagonal() * hadamard();
  e.b = directions.leftCols(alive).rowwise().sum() + noise * randomMatrix(600, 1, seed + 2);
  for (int row = 0; row < 600; ++row) {
    e.actuator.push_back(0);
    e.block.push_back(row / 60);
  }
  return e;
}

/// Mean square over fresh equations of what the parameters at one strength leave of them, without their noise.
double errorElsewhere(const Equations& trained, const std::vector<Column>& columns, const Prior& prior, double strength,
                      int alive) {
  const Reduction r = reduce(joinBlocks(compressBlocks(trained), -1), columns, std::vector<char>(16, 1), prior);
  const Eigen::VectorXd p = toParameters(r, solveWithPrior(r, r.maximalRank(), strength));
  const Equations fresh = fallingEquations(alive, 0.0, 9999);
  return (fresh.a * p - fresh.b).squaredNorm() / fresh.rows();
}

TEST(ChooseStrength, ComesNearTheBestStrengthOnOtherEquationsThanItsOwn) {
  const std::vector<Column> columns(16, Column{"r", "", ColumnRole::Rigid, -1});
  const Prior prior = unitPrior(columns);
  int near = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Equations e = fallingEquations(6, 1.0, 10 * seed);
    const PriorChoice choice = chooseStrength(e, columns, std::vector<char>(16, 1), prior);
    double best = 1e300, worst = 0.0;
    for (const StrengthPoint& point : choice.curve) {
      const double error = errorElsewhere(e, columns, prior, point.strength, 6);
      best = std::min(best, error);
      worst = std::max(worst, error);
    }
    const double chosen = errorElsewhere(e, columns, prior, choice.strength, 6);
    EXPECT_LT(chosen, 0.2 * worst) << "seed " << seed;
    near += chosen < 3.0 * best;
  }
  std::cout << near << " of 40 choices leave less than three times the best's error elsewhere\n";
  EXPECT_GE(near, 32);
}

TEST(ChooseStrength, KeepsToThePriorWhereItIsRight) {
  const std::vector<Column> columns(16, Column{"r", "", ColumnRole::Rigid, -1});
  Prior prior = unitPrior(columns);
  const Equations e = fallingEquations(6, 1.0, 77);
  prior.mean = fallingEquations(6, 0.0, 77).a.householderQr().solve(fallingEquations(6, 0.0, 77).b);
  const PriorChoice choice = chooseStrength(e, columns, std::vector<char>(16, 1), prior);
  EXPECT_EQ(choice.strength, choice.curve.front().strength);
  EXPECT_EQ(choice.rank, 0);
}

TEST(ChooseStrength, TakesNoStrengthThatNeedsBodiesFarFromDrawnOnes) {
  const std::vector<Column> columns(16, Column{"r", "", ColumnRole::Rigid, -1});
  Prior prior = unitPrior(columns);
  prior.links = 16;
  Equations e = fallingEquations(6, 1.0, 77);
  const PriorChoice free = chooseStrength(e, columns, std::vector<char>(16, 1), prior);
  EXPECT_TRUE(std::all_of(free.curve.begin(), free.curve.end(), [](const StrengthPoint& p) { return p.believed; }));
  const auto chosen = [](const PriorChoice& c) {
    return *std::find_if(c.curve.begin(), c.curve.end(),
                         [&](const StrengthPoint& p) { return p.strength == c.strength; });
  };
  prior.largest_change = 0.9 * chosen(free).largest_change;
  const PriorChoice drawn = chooseStrength(e, columns, std::vector<char>(16, 1), prior);
  EXPECT_GT(drawn.strength, free.strength);
  EXPECT_LE(chosen(drawn).largest_change, prior.largest_change);
  EXPECT_EQ(drawn.curve.back().held_back, free.curve.back().held_back);
}

TEST(MiddleStrength, LiesHalfwayInDecadesBetweenTheBestAndTheStrongestAsGood) {
  PriorChoice choice;
  choice.strength = 1e4;
  const double beyond_best[] = {0.4, 0.1, 0.05, 0.0, 0.2};  // at 1e5, 1e4, 1e3, 1e2, 1e1
  double strength = 1e5;
  for (const double beyond : beyond_best) {
    StrengthPoint point;
    point.strength = strength;
    point.beyond_best = beyond;
    choice.curve.push_back(point);
    strength /= 10.0;
  }
  choice.curve.back().believed = false;
  choice.curve.back().beyond_best = -0.1;  // better by bodies that nobody believes
  EXPECT_NEAR(middleStrength(choice), 1e3, 1e-6);
  choice.strength = 1e2;
  EXPECT_NEAR(middleStrength(choice), 1e2, 1e-9) << "the best is the strongest";
}

TEST(ChooseStrength, TrainingErrorFallsWithTheStrength) {
  const std::vector<Column> columns(16, Column{"r", "", ColumnRole::Rigid, -1});
  const PriorChoice choice =
      chooseStrength(fallingEquations(6, 1.0, 77), columns, std::vector<char>(16, 1), unitPrior(columns));
  for (std::size_t k = 1; k < choice.curve.size(); ++k) {
    EXPECT_LE(choice.curve[k].training, choice.curve[k - 1].training + 1e-9);
    EXPECT_GE(choice.curve[k].beyond_best, 0.0);
  }
}

}  // namespace
}  // namespace knee_robot::identification
