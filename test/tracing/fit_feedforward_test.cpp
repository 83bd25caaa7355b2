// A controller is given numbers that were fitted without what it cannot give.
#include "src/tracing/fit_feedforward.h"

#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class FitFeedforward : public SearchedMachine {
 protected:
  FitFeedforward() {
    search_.options = &options_;
    result_.baseline = base_;
  }
  /// The search has found these, and all of them are predicted in other recordings.
  void finds(const std::vector<Hypothesis>& hypotheses) {
    search_.effects.clear();
    for (const Hypothesis& hypothesis : hypotheses) {
      FoundEffect e;
      e.hypothesis = hypothesis;
      e.transfers = true;
      search_.effects.push_back(e);
    }
    refit(search_);
    result_.effects = search_.effects;
    result_.base = *search_.base;
    result_.parameters = base_.parametersOf(search_.fit.base);
  }
  /// Force (N) of a model with these parameters along the first recording, at the actuator.
  Eigen::VectorXd along(const Eigen::VectorXd& parameters) const {
    return data_.recordings.front().regressor[kActuator] * parameters;
  }

  TraceOptions options_;
  TraceResult result_;
  const Hypothesis lost_ = named("drive_dead_zone", {0.5});
  const Hypothesis gain_ = named("force_gain", {});
};

TEST_F(FitFeedforward, IsTheBaselineWhereNothingThatWasFoundCanBeFedForward) {
  has(lost_, Eigen::VectorXd::Constant(1, 8.0));
  finds({lost_});
  fitFeedforward(search_, result_, false);
  ASSERT_TRUE(result_.feedforward);
  EXPECT_TRUE(result_.feedforward->effects.empty());
  EXPECT_EQ(result_.feedforward->parameters, result_.baseline.parameters);
  EXPECT_TRUE(result_.feedforward->base.friction_laws == result_.baseline.friction_laws);
  EXPECT_FALSE(result_.notes.empty());
  EXPECT_EQ(search_.effects.size(), 1u) << "predictions along recordings keep it";
  EXPECT_TRUE(base_.friction_laws == result_.base.friction_laws);
}

TEST_F(FitFeedforward, KeepsWhatHasALawAndTakesUpWhatItCanOfTheRest) {
  const Hypothesis spring = {named("nonlinear_spring", {}).place,
                             named("nonlinear_spring", {}).place.candidate->shapes(data_.inputs.front(), -1).front()};
  has(spring, Eigen::Vector4d(20.0, 300.0, 50.0, 100.0));
  has(gain_, Eigen::VectorXd::Constant(1, 0.1));
  finds({spring, gain_});
  const Eigen::VectorXd force_N = data_.recordings.front().force_filtered_N.col(kActuator);
  const double beside = (force_N - along(result_.parameters)).norm();
  fitFeedforward(search_, result_, false);
  ASSERT_TRUE(result_.feedforward);
  ASSERT_EQ(result_.feedforward->effects.size(), 1u);
  EXPECT_EQ(result_.feedforward->effects[0].hypothesis.place.candidate->name(), "force_gain");
  EXPECT_LT((force_N - along(result_.feedforward->parameters)).norm(), beside);
}

TEST_F(FitFeedforward, IsNotWrittenWhereAllHasALaw) {
  has(gain_, Eigen::VectorXd::Constant(1, 0.1));
  finds({gain_});
  fitFeedforward(search_, result_, false);
  EXPECT_FALSE(result_.feedforward);
  EXPECT_TRUE(result_.notes.empty());
}

TEST_F(FitFeedforward, WhatIsThePatientsStaysInTheFitAndOutOfTheController) {
  const Hypothesis joint = {named("passive_joint", {}).place,
                            named("passive_joint", {}).place.candidate->shapes(data_.inputs.front(), -1).front()};
  finds({joint, lost_});
  fitFeedforward(search_, result_, false);
  ASSERT_TRUE(result_.feedforward);
  EXPECT_TRUE(result_.feedforward->effects.empty());
  EXPECT_NE(result_.feedforward->parameters, result_.baseline.parameters) << "fitted beside the joint";
  result_.feedforward = nullptr;
  finds({joint});
  fitFeedforward(search_, result_, false);
  EXPECT_FALSE(result_.feedforward) << "what the next patient's knee asks for is not known";
}

}  // namespace
}  // namespace knee_robot::tracing
