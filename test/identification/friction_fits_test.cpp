// Sums of squares say of a law of friction what the rows themselves say.
#include "src/identification/friction_fits.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>

namespace knee_robot::identification {
namespace {

constexpr int kBase = 5, kCandidates = 6, kTogether = 4;  ///< the last two candidates stand alone
constexpr double kRidge = 0.3;

/// Rows of a regression, some of them held back.
struct Rows {
  Eigen::MatrixXd base, candidates;
  Eigen::VectorXd target;

  explicit Rows(int count)
      : base(Eigen::MatrixXd::Random(count, kBase)),
        candidates(Eigen::MatrixXd::Random(count, kCandidates)),
        target(Eigen::VectorXd::Random(count) + 0.8 * candidates.col(1) + 0.5 * candidates.col(3) +
               0.6 * candidates.col(5)) {}
  FrictionBlock sums() const {
    const Eigen::MatrixXd together = candidates.leftCols(kTogether);
    return {base.transpose() * base,
            base.transpose() * candidates,
            together.transpose() * together,
            candidates.colwise().squaredNorm().transpose(),
            base.transpose() * target,
            candidates.transpose() * target,
            target.squaredNorm(),
            static_cast<double>(target.size())};
  }
  Eigen::VectorXd law(const std::vector<int>& which, const Eigen::VectorXd& weights) const {
    return candidates(Eigen::all, which) * weights;
  }
};

class FrictionFits : public testing::Test {
 protected:
  FrictionFits() : fitted_(eliminateBase(training_.sums(), Eigen::VectorXd::Constant(kBase, kRidge), left_)) {}

  /// The base's coordinates beside a law, from the rows.
  Eigen::VectorXd beside(const Eigen::VectorXd& law) const {
    Eigen::MatrixXd a(training_.base.rows() + kBase, kBase);
    a << training_.base, std::sqrt(kRidge) * Eigen::MatrixXd::Identity(kBase, kBase);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(a.rows());
    b.head(law.size()) = training_.target - law;
    return a.colPivHouseholderQr().solve(b);
  }

  const Rows training_ = Rows(40), held_back_ = Rows(15);
  InWeights left_;
  const FittedBase fitted_;
};

TEST_F(FrictionFits, SayWhatALawLeavesOnHeldBackRowsWithTheBaseThatWasFittedBesideIt) {
  struct Law {
    std::vector<int> which;
    Eigen::VectorXd weights;
  };
  const Law laws[] = {
      {{}, Eigen::VectorXd()}, {{5}, Eigen::VectorXd::Constant(1, 0.7)}, {{1, 3}, Eigen::Vector2d(0.8, 0.4)}};
  for (const Law& law : laws) {
    const Eigen::VectorXd base = beside(training_.law(law.which, law.weights));
    const double expected =
        (held_back_.target - held_back_.base * base - held_back_.law(law.which, law.weights)).squaredNorm();
    EXPECT_NEAR(fitted_.leftOn(held_back_.sums(), law.which, law.weights), expected, 1e-7 * expected);
  }
}

TEST_F(FrictionFits, SayWhatALawLeavesOnTheRowsOfTheFitAndItsRidge) {
  const std::vector<int> which = {1, 3};
  const Eigen::Vector2d weights(0.8, 0.4);
  const Eigen::VectorXd law = training_.law(which, weights), base = beside(law);
  const double expected = (training_.target - training_.base * base - law).squaredNorm() + kRidge * base.squaredNorm();
  EXPECT_NEAR(left_.at(which, weights), expected, 1e-7 * expected);
}

TEST_F(FrictionFits, GiveAPairAtOnceWhatItsBestWeightsLeave) {
  int pairs = 0;
  for (int i = 0; i < kTogether; ++i) {
    for (int j = i + 1; j < kTogether; ++j) {
      const Eigen::VectorXd weights = positiveWeights(left_, {i, j});
      const double expected = weights.size() == 0 ? std::numeric_limits<double>::infinity() : left_.at({i, j}, weights);
      const double said = leftByPair(left_, i, j);
      EXPECT_EQ(std::isinf(said), std::isinf(expected)) << i << " " << j;
      if (std::isinf(expected)) continue;
      EXPECT_NEAR(said, expected, 1e-12 * expected) << i << " " << j;
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 0);
}

TEST_F(FrictionFits, TakeTheSizeOfALawWhoseSharesAreGiven) {
  const std::vector<int> which = {1, 3};
  const Eigen::Vector2d shares(0.6, 0.4);
  const double best = left_.along(which, shares);
  for (const double other : {0.98, 1.02})
    EXPECT_GT(left_.at(which, other * best * shares), left_.at(which, best * shares));
}

}  // namespace
}  // namespace knee_robot::identification
