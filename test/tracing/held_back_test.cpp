// What a model that is fitted without one of the paths says of it.
#include "src/tracing/held_back.h"

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class HeldBackPaths : public SearchedMachine {
 protected:
  HeldBackPaths() { search_.attention = Attention::All; }

  /// Force of an effect of one coefficient along the first path, and along the second.
  void hasAlongPaths(const Hypothesis& hypothesis, double first, double second) {
    has(hypothesis, Eigen::VectorXd::Constant(1, second));
    hasIn(0, hypothesis, Eigen::VectorXd::Constant(1, first - second));
  }
  void finds(const std::vector<Hypothesis>& hypotheses) {
    for (const Hypothesis& h : hypotheses) {
      FoundEffect e;
      e.hypothesis = h;
      search_.effects.push_back(e);
    }
    refit(search_);
  }
  void ask() { holdBackOfPaths(search_, baseline_, notes_); }

  const Hypothesis gain_ = named("force_gain", {});
  const BaseFit baseline_ = base_;  ///< base_ is the search's
  std::vector<std::string> notes_;
};

TEST_F(HeldBackPaths, AnEffectThatIsTheSameAlongBothIsPredictedElsewhere) {
  hasAlongPaths(gain_, 0.15, 0.15);
  finds({gain_});
  ask();
  EXPECT_TRUE(search_.effects[0].transfers);
  EXPECT_TRUE(notes_.empty()) << notes_[0];
}

TEST_F(HeldBackPaths, AnEffectThatIsMuchLessAlongOneOfThemIsNot) {
  hasAlongPaths(gain_, 0.25, 0.05);
  finds({gain_});
  ask();
  EXPECT_FALSE(search_.effects[0].transfers);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_EQ(
      notes_[0].rfind(
          "force_gain on actuator 2: fitted without one of the paths it makes the error along that path larger (", 0),
      0u)
      << notes_[0];
}

/// How warm each recording began is known while it is there. It cannot be told from what all have once one path is left.
TEST_F(HeldBackPaths, FrictionThatFallsAsDrivesWarmUpIsPredictedElsewhere) {
  const Hypothesis drift = named("thermal_drift", {20.0, 0.0, 0.0, 0.0, 0.0});
  Eigen::VectorXd changes(4);
  changes << -6.0, -40.0, 0.0, 0.0;
  has(drift, changes);
  finds({drift});
  ask();
  EXPECT_TRUE(search_.effects[0].transfers);
  EXPECT_TRUE(notes_.empty()) << notes_[0];
}

TEST_F(HeldBackPaths, NothingIsPredictedBesideALawThatIsWorseThanTheBaselines) {
  hasAlongPaths(gain_, 0.02, 0.02);
  rubBy(dynamics::smoothLaw(8e-3));
  finds({gain_});
  ask();
  EXPECT_FALSE(search_.effects[0].transfers);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_EQ(notes_[0].rfind("Fitted without one of the paths the model with what was found predicts", 0), 0u)
      << notes_[0];
}

TEST_F(HeldBackPaths, WhatSpeaksAgainstItselfIsLeftOutAndTheOtherStays) {
  Hypothesis other = gain_;
  other.place.actuator = 2;
  hasAlongPaths(gain_, 0.4, -0.3);
  hasAlongPaths(other, 0.1, 0.1);
  finds({other, gain_});
  ask();
  EXPECT_TRUE(search_.effects[0].transfers);
  EXPECT_FALSE(search_.effects[1].transfers);
  EXPECT_EQ(notes_.size(), 1u);
}

TEST(HarmsElsewhere, AForceOverThePoseMustHelpInMotionAndAtRestOthersInOneOfThem) {
  EXPECT_FALSE(harmsElsewhere(-0.01, 0.13, false));
  EXPECT_FALSE(harmsElsewhere(0.13, -0.01, false));
  EXPECT_TRUE(harmsElsewhere(-0.01, -0.01, false));
  EXPECT_TRUE(harmsElsewhere(-0.01, 0.13, true));
  EXPECT_TRUE(harmsElsewhere(0.13, -0.01, true));
  EXPECT_FALSE(harmsElsewhere(0.13, 0.13, true));
}

TEST_F(HeldBackPaths, OfOnePathNobodyIsAsked) {
  data_.recordings[1] = data_.recordings[0];
  hasAlongPaths(gain_, 0.25, 0.05);
  finds({gain_});
  ask();
  EXPECT_TRUE(search_.effects[0].transfers);
  EXPECT_TRUE(notes_.empty());
}

}  // namespace
}  // namespace knee_robot::tracing
