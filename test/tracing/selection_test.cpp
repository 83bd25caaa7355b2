#include "src/tracing/selection.h"

#include <gtest/gtest.h>

#include <random>

namespace knee_robot::tracing {
namespace {

TEST(HeldBackGain, IsTheMeanItsErrorAndTheShareThatGains) {
  const HeldBackGain g = heldBackGain(Eigen::Vector4d(1.0, 3.0, -1.0, 5.0));
  EXPECT_DOUBLE_EQ(g.mean, 2.0);
  EXPECT_NEAR(g.error, std::sqrt(20.0 / 12.0), 1e-12);
  EXPECT_DOUBLE_EQ(g.gaining, 0.75);
}

TEST(HeldBackGain, IsSureWhereEveryOneOfManyBlocksGainsHoweverUnequally) {
  Eigen::VectorXd gains = Eigen::VectorXd::Constant(12, 1.0);
  gains[3] = gains[4] = gains[5] = 300.0;
  EXPECT_NEAR(heldBackGain(gains).error, heldBackGain(gains).mean / 3.0, 1e-9);
  gains[0] = -1.0;
  EXPECT_GT(heldBackGain(gains).error, heldBackGain(gains).mean / 2.5) << "one block lost: the spread speaks";
  EXPECT_GT(heldBackGain(gains.segment(1, 5)).error, heldBackGain(gains.segment(1, 5)).mean / 3.0) << "too few blocks";
}

TEST(MaxNull, IsNotCrossedByChanceMoreOftenThanItsPSays) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 1.0);
  constexpr int kPlaces = 40, kDraws = 199, kCases = 300;
  int crossed = 0;
  for (int c = 0; c < kCases; ++c) {
    Eigen::MatrixXd roots(kPlaces, kDraws + 1);
    for (Eigen::Index place = 0; place < kPlaces; ++place) {
      for (Eigen::Index d = 0; d <= kDraws; ++d)
        roots(place, d) = 1.0 + static_cast<double>(place) + (1.0 + 0.1 * static_cast<double>(place)) * normal(random);
    }
    const MaxNull null = maxNull(roots.leftCols(kDraws), 0.0, 1e-9);
    bool any = false;
    for (Eigen::Index place = 0; place < kPlaces; ++place)
      any = any || null.p(place, roots(place, kDraws)) <= 0.05;
    crossed += any;
  }
  EXPECT_LT(crossed, 0.09 * kCases);
  EXPECT_GT(crossed, 0.02 * kCases) << "a null that nothing crosses finds nothing either";
}

/// Explanations with fixed values; every acceptance takes the best one out.
class Listed : public SelectionProblem {
 public:
  explicit Listed(std::vector<SelectionTrial> trials) : trials_(std::move(trials)) {}
  std::vector<SelectionTrial> compare() override { return trials_; }
  MaxNull null() override {
    ++nulls;
    return maxNull(Eigen::MatrixXd::Random(4, 400), -10.0, 1e-9);
  }
  bool accept(std::size_t k, const MaxNull&, double) override {
    accepted.push_back(trials_[k].name);
    trials_.erase(trials_.begin() + static_cast<std::ptrdiff_t>(k));
    return true;
  }
  std::vector<std::string> accepted;
  int nulls = 0;

 private:
  std::vector<SelectionTrial> trials_;
};

TEST(SelectForward, TakesTheBestThatNothingSpeaksAgainstUntilTheNullEndsIt) {
  Listed problem({{0, 9.0, "wrong sign", "the sign is not physical"},
                  {1, 8.0, "first", ""},
                  {2, 7.0, "second", ""},
                  {3, 0.1, "chance", ""}});
  std::vector<std::string> rejected;
  EXPECT_EQ(selectForward(problem, 5, 0.005, rejected), 2);
  EXPECT_EQ(problem.accepted, (std::vector<std::string>{"first", "second"}));
  ASSERT_EQ(rejected.size(), 2u);
  EXPECT_EQ(rejected[0], "wrong sign: the sign is not physical");
  EXPECT_EQ(rejected[1].rfind("chance: surrogates explain as much", 0), 0u) << rejected[1];
}

TEST(SelectForward, AsksForNoNullWhenEverythingIsObjectedTo) {
  Listed problem({{0, 9.0, "a", "too small"}});
  std::vector<std::string> rejected;
  EXPECT_EQ(selectForward(problem, 5, 0.005, rejected), 0);
  EXPECT_EQ(problem.nulls, 0);
}

TEST(SelectForward, AddsNoMoreThanItMay) {
  Listed problem({{1, 8.0, "first", ""}, {2, 7.0, "second", ""}});
  std::vector<std::string> rejected;
  EXPECT_EQ(selectForward(problem, 1, 0.005, rejected), 1);
}

}  // namespace
}  // namespace knee_robot::tracing
