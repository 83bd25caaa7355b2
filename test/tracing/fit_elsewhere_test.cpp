// What is predicted in other recordings is fitted without what is left out there, laws near rest too.
#include <algorithm>

#include "src/tracing/elsewhere.h"
#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class FitElsewhere : public SearchedMachine {
 protected:
  FitElsewhere() { search_.options = &options_; }
  FoundEffect found(const Hypothesis& hypothesis, bool transfers) const {
    FoundEffect e;
    e.hypothesis = hypothesis;
    e.transfers = transfers;
    return e;
  }
  /// Largest change of the model's forces along the first recording, N.
  double changed(const Eigen::VectorXd& before, const Eigen::VectorXd& after) const {
    return (data_.recordings.front().regressor[kActuator] * (after - before)).cwiseAbs().maxCoeff();
  }
  /// rms of the actuator, N, with the baseline alone.
  double leftByBaseline() {
    search_.effects.clear();
    refit(search_);
    return search_.rms_N[kActuator];
  }

  TraceOptions options_;
  const BaseFit baseline_ = base_;  ///< base_ is the search's
};

TEST_F(FitElsewhere, LawsNearRestAreChosenAnewBesideWhatIsPredicted) {
  const Hypothesis build_up = named("presliding", {0.4e-3});
  has(build_up, Eigen::VectorXd::Constant(1, 20.0));
  search_.effects = {found(build_up, false)};
  refit(search_);
  rebase(search_);
  const std::vector<FoundEffect> all = search_.effects;
  BaseFit beside = base_;
  fitElsewhere(search_, baseline_, true);
  const double kept = leftByBaseline();
  search_.effects = all;
  refit(search_);
  adoptBase(search_, beside);
  const ElsewhereFit anew = fitElsewhere(search_, baseline_, false);
  EXPECT_TRUE(anew.effects.empty());
  EXPECT_EQ(search_.effects.size(), 1u) << "the model of the training recordings keeps what is left out elsewhere";
  EXPECT_LT(leftByBaseline(), 0.7 * kept);
}

TEST_F(FitElsewhere, ARippleThatStaysBehindDoesNotOutweighWhatIsPredicted) {
  Hypothesis ripple = named("screw_ripple", {0.0115, 0.0});
  ripple.place.actuator = 0;
  const Hypothesis gain = named("force_gain", {});
  has(ripple, Eigen::Vector4d(40.0, -25.0, -10.0, 45.0));
  has(gain, Eigen::VectorXd::Constant(1, 0.08));
  search_.effects = {found(gain, true)};
  for (FoundEffect& e : search_.effects)
    e.coefficients = Eigen::VectorXd::Constant(1, 0.08);
  search_.effects.push_back(found(ripple, false));
  refit(search_);
  std::cout << "left with both: " << search_.rms_N.transpose() << " N\n";
  EXPECT_TRUE(helpsElsewhere(search_, baseline_));
}

TEST_F(FitElsewhere, APushAloneIsTakenOutOfTrainingUnlessItMayBeAnotherForce) {
  const Hypothesis push = {{named("external_force", {}).place.candidate, -1}, {1.0, 6.0, 9.0}};
  has(push, Eigen::Vector4d(25.0, -40.0, 3.0, 2.0));
  search_.effects = {found(push, false)};
  refit(search_);
  EXPECT_TRUE(helpsElsewhere(search_, baseline_));
  search_.effects[0].indistinguishable_from = {"unnamed"};
  EXPECT_FALSE(helpsElsewhere(search_, baseline_)) << "laws near rest chosen anew beside it would be all that changes";
}

TEST_F(FitElsewhere, AMassThatSlidesIsNotPredictedAndTheRestIsFittedWithoutIt) {
  const Hypothesis mass = named("sliding_mass", {0.8, 0.1, 0.4, 1.0, 0.5, -0.5, 0.0});
  has(mass, Eigen::VectorXd::Constant(1, 6.0));
  search_.effects = {found(mass, true)};
  refit(search_);
  const Eigen::VectorXd beside = base_.parametersOf(search_.fit.base);
  std::vector<std::string> notes;
  testElsewhere(search_, notes);
  EXPECT_FALSE(search_.effects[0].transfers);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].rfind("sliding_mass (all actuators): ", 0), 0u) << notes[0];
  const ElsewhereFit elsewhere = fitElsewhere(search_, baseline_, true);
  EXPECT_TRUE(elsewhere.effects.empty());
  EXPECT_GT(changed(beside, elsewhere.parameters), 1.0);
}

TEST_F(FitElsewhere, WhatAPushDidToTrainingStaysOutOfTheParameters) {
  const Eigen::VectorXd before = base_.parameters;
  const Hypothesis push = {{named("external_force", {}).place.candidate, -1}, {1.0, 6.0, 9.0}};
  has(push, Eigen::Vector4d(40.0, -120.0, 6.0, 4.0));
  search_.effects = {};
  refit(search_);
  ASSERT_GT(changed(before, base_.parametersOf(search_.fit.base)), 3.0);
  search_.effects = {found(push, false)};
  const ElsewhereFit elsewhere = fitElsewhere(search_, baseline_, false);
  EXPECT_TRUE(elsewhere.effects.empty());
  EXPECT_LT(changed(before, elsewhere.parameters), 1.0);
}

}  // namespace
}  // namespace knee_robot::tracing
