// What a wrong law near rest makes out of drag is drag, with the right law; friction that falls off stays what it is.
#include "src/tracing/taken_for.h"

#include "src/tracing/library.h"
#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr double kDrag = 400.0;  // N s2/m2

class TakenFor : public SearchedMachine {
 protected:
  TakenFor() {
    for (auto& candidate : namedCandidates(robot_)) {
      if (candidate->name() == "quadratic_drag") drag_.push_back(std::move(candidate));
    }
    library_.add(drag_, data_);
    search_.library = &library_;
    search_.options = &options_;
  }
  void find(const Hypothesis& hypothesis) {
    FoundEffect effect;
    effect.hypothesis = hypothesis;
    effect.p = 0.004;
    effect.explained_rms_N = Eigen::VectorXd::Constant(data_.stack.axes, 1e3);
    search_.effects = {effect};
    refit(search_);
  }
  std::string found() const { return search_.effects[0].hypothesis.place.candidate->name(); }

  Library library_;

 private:
  CandidateList drag_;
  const TraceOptions options_;
};

TEST_F(TakenFor, FrictionThatFallsOffBesideAWrongLawGivesWayToDragWithTheRightOne) {
  const Eigen::VectorXd right_N = search_.rms_N;
  has(named("quadratic_drag", {}), Eigen::VectorXd::Constant(1, kDrag));
  rubBy(dynamics::smoothLaw(4e-3));
  find(named("stribeck", {0.03, 2.0, 0.0}));
  preferSimpler(search_);
  ASSERT_EQ(search_.effects.size(), 1u);
  EXPECT_EQ(found(), "quadratic_drag");
  EXPECT_NEAR(search_.effects[0].coefficients[0], kDrag, 0.05 * kDrag);
  EXPECT_LT(search_.rms_N[kActuator], 1.1 * right_N[kActuator]);
  EXPECT_LT(search_.effects[0].explained_rms_N[kActuator], 100.0) << "what it explains is said of it, not of the other";
  ASSERT_EQ(search_.taken_out.size(), 1u);
  EXPECT_NE(search_.taken_out[0].find("stribeck on actuator 2: quadratic_drag explains"), std::string::npos)
      << search_.taken_out[0];
}

TEST_F(TakenFor, FrictionThatFallsOffStays) {
  const Hypothesis stribeck = named("stribeck", {0.008, 2.0, 0.0});
  has(stribeck, Eigen::VectorXd::Constant(1, 8.0));
  find(stribeck);
  const BaseFit base = base_;
  const Eigen::VectorXd left_N = search_.rms_N;
  preferSimpler(search_);
  EXPECT_EQ(found(), "stribeck");
  EXPECT_EQ(base_.friction_laws, base.friction_laws);
  EXPECT_NEAR(search_.rms_N[kActuator], left_N[kActuator], 1e-3 * left_N[kActuator]);
  EXPECT_TRUE(search_.taken_out.empty());
}

TEST_F(TakenFor, WithoutAnEffectThatCouldBeAnotherNothingIsFittedAgain) {
  has(named("quadratic_drag", {}), Eigen::VectorXd::Constant(1, kDrag));
  find(named("quadratic_drag", {}));
  const Eigen::VectorXd parameters = base_.parameters;
  preferSimpler(search_);
  EXPECT_EQ(found(), "quadratic_drag");
  EXPECT_EQ((base_.parameters - parameters).norm(), 0.0);
}

}  // namespace
}  // namespace knee_robot::tracing
