// Friction that falls off before it has built up is the law near rest, not Stribeck friction.
#include <cmath>

#include "src/tracing/decide.h"
#include "src/tracing/refit.h"
#include "src/tracing/settle_rest_law.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class PlausibleShape : public SearchedMachine {
 protected:
  bool isStribeck(double velocity_m_per_s, double smooth_below_m_per_s) const {
    const std::vector<double> shape = {velocity_m_per_s, 2.0, smooth_below_m_per_s};
    return named("stribeck", shape).place.candidate->plausibleShape(shape);
  }
  std::size_t leftOf(double velocity_m_per_s, double p) {
    FoundEffect found;
    found.hypothesis = named("stribeck", {velocity_m_per_s, 2.0, 0.0});
    found.p = p;
    search_.effects = {found};
    refit(search_);
    dropImplausible(search_);
    return search_.effects.size();
  }
};

TEST_F(PlausibleShape, OfStribeckFrictionFallsOffAfterItHasBuiltUp) {
  EXPECT_TRUE(isStribeck(0.012, 0.0));
  EXPECT_TRUE(isStribeck(0.007, 0.001));
  EXPECT_FALSE(isStribeck(0.004, 0.0028));
  EXPECT_FALSE(isStribeck(0.002, 0.0)) << "at the end of what is looked for";
}

TEST_F(PlausibleShape, IsAskedOfWhatWasRefined) {
  EXPECT_EQ(leftOf(0.01, 0.004), 1u);
  EXPECT_TRUE(search_.taken_out.empty());
  EXPECT_EQ(leftOf(0.002, 0.004), 0u);
  ASSERT_EQ(search_.taken_out.size(), 1u);
  EXPECT_EQ(search_.taken_out[0], "stribeck on actuator 2: the shape that fits is not physical");
  EXPECT_EQ(leftOf(0.002, std::nan("")), 1u) << "of a given model, named where it was found";
}

TEST_F(PlausibleShape, AndOfTheSizeThatFitsInTheEnd) {
  const Hypothesis play = named("backlash", {0.4e-3, 1.0});
  FoundEffect found;
  found.hypothesis = play;
  found.p = 0.004;
  for (const double share : {0.9, -0.7}) {  // then 0.2 of it is left
    has(play, Eigen::VectorXd::Constant(1, share));
    search_.effects = {found};
    refit(search_);
    dropImplausible(search_);
    EXPECT_EQ(search_.effects.size(), share > 0.5 ? 1u : 0u);
  }
  ASSERT_EQ(search_.taken_out.size(), 1u);
  EXPECT_EQ(search_.taken_out[0], "backlash on actuator 2: no machine has the size that fits");
}

TEST_F(PlausibleShape, ASizeWithinThreeStandardErrorsOfNoneIsNone) {
  FoundEffect friction;
  friction.hypothesis = named("load_dependent_friction", {0.0});
  friction.p = 0.004;
  const auto sureness = [&] { return std::abs(search_.effects[0].coefficients[0]) / search_.effects[0].std[0]; };
  has(friction.hypothesis, Eigen::VectorXd::Constant(1, 0.1));
  search_.effects = {friction};
  refit(search_);
  ASSERT_GT(sureness(), 6.0);
  dropUnsized(search_);
  EXPECT_EQ(search_.effects.size(), 1u);

  has(friction.hypothesis, Eigen::VectorXd::Constant(1, -search_.effects[0].coefficients[0]));  // nothing is left of it
  search_.effects = {friction};
  refit(search_);
  ASSERT_LT(sureness(), 3.0);
  search_.effects[0].p = std::nan("");
  dropUnsized(search_);
  ASSERT_EQ(search_.effects.size(), 1u) << "of a given model, found where it was surer";
  search_.effects[0].p = 0.004;
  search_.effects[0].band_hz = 10.0;
  dropUnsized(search_);
  ASSERT_EQ(search_.effects.size(), 1u) << "found in the fast band, which these rows hardly show";
  search_.effects[0].band_hz = 0.0;
  dropUnsized(search_);
  EXPECT_TRUE(search_.effects.empty());
  ASSERT_EQ(search_.taken_out.size(), 1u);
  EXPECT_NE(
      search_.taken_out[0].find("its size is not known beside the baseline and the other effects (friction_per_load"),
      std::string::npos)
      << search_.taken_out[0];
}

TEST_F(PlausibleShape, WhatIsAlwaysDoubtedTakesNothingsPlace) {
  const TraceOptions options;
  search_.options = &options;
  FoundEffect friction;  // nothing of which is there: held-back blocks are predicted as well without it
  friction.hypothesis = named("load_dependent_friction", {0.0});
  friction.p = 0.004;
  for (const auto& [name, left] : {std::pair("dashpot", 1u), {"stretch_reflex", 2u}}) {
    FoundEffect shared;
    shared.hypothesis = named(name, {});
    shared.hypothesis.shape = shared.hypothesis.place.candidate->shapes(data_.inputs.front(), -1).front();
    shared.p = 0.004;
    search_.effects = {friction, shared};
    refit(search_);
    standAlone(search_, shared.hypothesis.place);
    EXPECT_EQ(search_.effects.size(), left) << name;
  }
}

TEST_F(PlausibleShape, WithoutOneOfItsOwnTheLawOfTheActuatorIsFollowed) {
  const TraceOptions options;
  search_.options = &options;
  // What falls off faster than anything that is looked for: shapes end at the slowest, at which none is plausible.
  data_.all_force_rows += 15.0 * effectRows(data_, named("stribeck", {0.001, 2.0, 0.0})).col(0);
  setAttention(data_, Attention::All);
  FoundEffect found;
  found.hypothesis = named("stribeck", {0.002, 2.0, 0.0});
  search_.effects = {found};
  refit(search_);
  EXPECT_TRUE(settleRestLaw(search_, found.hypothesis.place.candidate));
  ASSERT_EQ(search_.effects.size(), 1u);
  EXPECT_EQ(search_.effects[0].hypothesis.shape.back(), 0.0);
}

}  // namespace
}  // namespace knee_robot::tracing
