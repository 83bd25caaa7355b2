// A name is only as good as what the model with it leaves.
#include "src/tracing/doubt.h"

#include <cmath>

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class Doubt : public SearchedMachine {
 protected:
  /// What is said of an effect when the model leaves so many noise floors.
  FoundEffect said(const std::string& name, double floors) {
    search_.floor.rms_N = Eigen::VectorXd::Constant(data_.stack.axes, 0.5);
    search_.floor.of_names_N = search_.floor.rms_N;
    search_.floor.measured = measured_;
    search_.fit.residual_N = Eigen::VectorXd::Constant(data_.stack.size() * data_.stack.axes, 0.5 * floors);
    FoundEffect e;
    e.hypothesis = named(name, shape_);
    e.coefficients = coefficients_;
    e.probability = probability_;
    e.p = p_;
    e.explained_rms_N = Eigen::VectorXd::Constant(data_.stack.axes, explains_N_);
    e.transfers = elsewhere_gain_ >= 0.0;
    e.elsewhere_gain = elsewhere_gain_;
    e.elsewhere_gaining = elsewhere_gaining_;
    search_.effects = {e};
    if (nameless_N_ > 0.0) {
      e.hypothesis.place.candidate = map_.get();
      e.explained_rms_N.setConstant(nameless_N_);
      search_.effects.push_back(e);
    }
    if (!beside_.empty()) {
      e.hypothesis = named(beside_, shape_);
      e.doubted = beside_doubted_;
      if (beside_doubted_) e.probability = 0.01;
      if (beside_explains_N_ > 0.0) e.explained_rms_N.setConstant(beside_explains_N_);
      search_.effects.push_back(e);
    }
    notes_.clear();
    doubtNames(search_, notes_);
    return search_.effects.front();
  }
  std::string beside_;  ///< another effect of the model
  bool beside_doubted_ = false;
  double beside_explains_N_ = 0.0;  ///< 0: as much
  std::vector<double> shape_;
  Eigen::VectorXd coefficients_;
  double p_ = 0.004;
  double explains_N_ = 9.0, nameless_N_ = 0.0;
  const std::unique_ptr<Candidate> map_ = mapCandidate(robot_, "pose_x_m", kActuator, {0, 1, 2, 3, 4, 5, 6, 7});
  bool measured_ = true;
  double probability_ = 0.99;
  double elsewhere_gain_ = 0.0, elsewhere_gaining_ = 1.0;
  std::vector<std::string> notes_;
};

TEST_F(Doubt, IsNotCastOnAModelThatComesNearTheNoiseFloor) {
  for (const char* name : {"dashpot", "stribeck"}) {
    EXPECT_EQ(said(name, 2.0).probability, 0.99) << name;
    EXPECT_TRUE(notes_.empty());
  }
}

TEST_F(Doubt, IsCastOnASwingingMassThatNobodyHas) {
  shape_ = {7.5, 0.35, 0.04, 0.3, 1.8, 0.04, 6.7};
  coefficients_ = Eigen::VectorXd::Constant(1, 6.0);
  EXPECT_EQ(said("wobbling_mass", 1.0).probability, 0.99);
  coefficients_[0] = 121.0;
  EXPECT_TRUE(said("wobbling_mass", 1.0).doubted);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("larger than anything of this name"), std::string::npos) << notes_[0];
}

TEST_F(Doubt, IsCastOnAllThatIsFoundWhereAnEncoderHasLostMillimetresForGood) {
  recording::Jump lost;
  lost.axis = 1;
  lost.beyond_m = 0.01;
  std::vector<recording::Jump>& jumps = data_.recordings[0].signals.jumps;
  jumps = {lost};
  for (const char* name : {"stribeck", "screw_ripple"})
    EXPECT_TRUE(said(name, 1.0).doubted) << name;
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("the position of actuator 2 jumps by 10 mm and does not come back"), std::string::npos)
      << notes_[0];
  recording::Jump back = lost;
  back.beyond_m = -0.0101;
  jumps.push_back(back);
  EXPECT_FALSE(said("stribeck", 1.0).doubted) << "it came back";
  jumps = {lost};
  jumps[0].frozen_s = 2.0;
  EXPECT_FALSE(said("stribeck", 1.0).doubted) << "a frozen encoder goes on where the axis is";
}

TEST_F(Doubt, IsAlwaysCastOnAStretchReflexWhichManyThingsLookLike) {
  EXPECT_TRUE(said("stretch_reflex", 1.0).doubted);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("so much looks like one"), std::string::npos) << notes_[0];
}

TEST_F(Doubt, GrowsWithWhatTheModelLeavesAndSaysSo) {
  for (const char* name : {"dashpot", "stribeck"}) {
    const FoundEffect some = said(name, 2.4), much = said(name, 6.6);
    EXPECT_GT(some.probability, 0.8);
    EXPECT_TRUE(some.indistinguishable_from.empty());
    EXPECT_FALSE(some.doubted);
    EXPECT_NEAR(much.probability, 0.99 / 9.0, 1e-9);
    EXPECT_TRUE(much.doubted);
    ASSERT_EQ(notes_.size(), 1u);
    EXPECT_NE(notes_[0].find("6.6 times the noise floor"), std::string::npos) << notes_[0];
  }
}

TEST_F(Doubt, ByAnEstimatedFloorWithoutRepeatsTakesNoNameAway) {
  measured_ = false;
  const FoundEffect much = said("spring", 9.0);
  EXPECT_EQ(much.probability, 0.5);
  EXPECT_FALSE(much.doubted);
  EXPECT_EQ(much.indistinguishable_from, std::vector<std::string>{"unnamed"});
}

TEST_F(Doubt, ByAnEstimatedFloorTakesNoNameAwayFromOneOfTwoThatAreAsProbable) {
  probability_ = 0.39;
  EXPECT_TRUE(said("asymmetric_coulomb", 2.8).doubted);
  measured_ = false;
  const FoundEffect one_of_two = said("asymmetric_coulomb", 2.8);
  EXPECT_FALSE(one_of_two.doubted);
  EXPECT_EQ(one_of_two.probability, 0.39);
  EXPECT_TRUE(notes_.empty());
}

TEST_F(Doubt, ReadsOrUnnamedWhereTheNameIsRatherRight) {
  const FoundEffect between = said("stribeck", 2.8);
  EXPECT_FALSE(between.doubted);
  EXPECT_EQ(between.indistinguishable_from, std::vector<std::string>{"unnamed"});
}

TEST_F(Doubt, IsCastOnANameThatDoesHarmAtHeldBackPositions) {
  elsewhere_gain_ = -0.1;
  const FoundEffect harmful = said("drive_lag", 1.0);
  EXPECT_TRUE(harmful.doubted);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("makes the error larger at held-back positions"), std::string::npos) << notes_[0];
  EXPECT_FALSE(said("screw_ripple", 1.0).doubted) << "has a signature of its own";
  measured_ = false;
  EXPECT_FALSE(said("drive_lag", 1.0).doubted) << "nobody knows how much noise there is";
  EXPECT_EQ(said("drive_lag", 1.0).indistinguishable_from, std::vector<std::string>{"unnamed"});
}

TEST_F(Doubt, IsCastOnANameThatHelpsAtSomeHeldBackPositionsOnly) {
  elsewhere_gaining_ = 0.92;
  EXPECT_FALSE(said("thermal_drift", 1.0).doubted);
  elsewhere_gaining_ = 0.6;
  EXPECT_TRUE(said("thermal_drift", 1.0).doubted);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("60 % of the held-back positions only"), std::string::npos) << notes_[0];
  EXPECT_FALSE(said("screw_ripple", 1.0).doubted) << "has a signature of its own";
}

TEST_F(Doubt, IsCastOnANameThatExplainsLessThanWhatIsLeft) {
  explains_N_ = 0.8;
  EXPECT_FALSE(said("stribeck", 1.0).doubted) << "noise is left";
  EXPECT_TRUE(said("stribeck", 2.0).doubted) << "1 N is left";
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("0.8 N, less than what is left there while axes move (1 N, 2 times the noise floor)"),
            std::string::npos)
      << notes_[0];
  explains_N_ = 1.2;
  EXPECT_FALSE(said("stribeck", 2.0).doubted);
}

TEST_F(Doubt, IsCastOnANameBesideItsOwnSpecialCase) {
  beside_ = "dashpot";
  EXPECT_FALSE(said("stribeck", 1.0).doubted);
  EXPECT_FALSE(said("spring", 1.0).doubted);
  EXPECT_TRUE(said("asymmetric_dashpot", 1.0).doubted);
  EXPECT_TRUE(search_.effects[1].doubted) << "neither is right";
  ASSERT_EQ(notes_.size(), 2u);
  EXPECT_NE(notes_[0].find("beside its own special case"), std::string::npos) << notes_[0];
}

TEST_F(Doubt, IsCastOnANameThatExplainsLessThanAMapBesideIt) {
  for (const char* name : {"dashpot", "stribeck"}) {
    explains_N_ = 1.0;
    nameless_N_ = 0.9;
    EXPECT_FALSE(said(name, 1.0).doubted) << name;
    nameless_N_ = 1.1;
    EXPECT_TRUE(said(name, 1.0).doubted) << name;
    ASSERT_EQ(notes_.size(), 1u);
    EXPECT_NE(notes_[0].find("less than what no name is known for there"), std::string::npos) << notes_[0];
  }
}

TEST_F(Doubt, IsCastOnANameThatMendsWhatALargerDoubtedNameDoesWrong) {
  beside_ = "presliding";
  shape_ = {0.008, 0.0006, 0.0, 0.0};
  for (const bool measured : {true, false}) {
    measured_ = measured;
    beside_explains_N_ = 12.0;
    EXPECT_FALSE(said("reversal_friction", 1.0).doubted) << "beside a name that stands";
    beside_doubted_ = true;
    EXPECT_TRUE(said("reversal_friction", 1.0).doubted) << "a doubt that needs no floor";
    ASSERT_EQ(notes_.size(), 1u);
    EXPECT_NE(notes_[0].find("explains 9 N, less than what no name is known for there (12 N)"), std::string::npos)
        << notes_[0];
    EXPECT_TRUE(search_.effects[1].doubted) << "still";
    beside_explains_N_ = 8.0;
    EXPECT_FALSE(said("reversal_friction", 1.0).doubted) << "explains the more";
    beside_doubted_ = false;
  }
}

TEST_F(Doubt, SparesWhatHasASignatureOfItsOwn) {
  EXPECT_EQ(said("screw_ripple", 9.0).probability, 0.99);
  shape_ = {1.0, 8.0, 2.0};  // of a push: recording, from_s, duration_s
  coefficients_ = Eigen::Vector4d(20.0, -60.0, 0.0, 0.0);
  EXPECT_EQ(said("external_force", 9.0).probability, 0.99);
  p_ = std::nan("");
  EXPECT_FALSE(said("stribeck", 9.0).doubted) << "of a given model, named where it was found";
}

TEST_F(Doubt, IsCastOnAPushThatLoadsOneLegAlone) {
  const EffectInput& input = data_.inputs.front();
  int middle = 0;
  while (input.time(middle) < 9.0)
    ++middle;
  shape_ = {1.0, 8.99, 0.02};
  coefficients_ = input.force_per_pose_force[static_cast<std::size_t>(middle)].inverse().col(kActuator) * 40.0;
  const FoundEffect one = said("external_force", 1.0);
  EXPECT_TRUE(one.doubted);
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("loads one leg alone"), std::string::npos) << notes_[0];
}

TEST_F(Doubt, OfAPushWhereTheRobotWasAtNoOtherTimeSaysOrUnnamed) {
  data_.recordings.back().signals.position_m.array() += 1.0;  // the other recording is elsewhere
  shape_ = {1.0, 0.5, 23.0};
  coefficients_ = Eigen::Vector4d(20.0, -60.0, 0.0, 0.0);
  const FoundEffect push = said("external_force", 1.0);
  EXPECT_FALSE(push.doubted);
  EXPECT_EQ(push.indistinguishable_from, std::vector<std::string>{"unnamed"});
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("at no other time"), std::string::npos) << notes_[0];
}

}  // namespace
}  // namespace knee_robot::tracing
