// A force that depends on the pose alone, seen along one path only.
#include "src/tracing/one_path.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

class OnePath : public testing::Test {
 protected:
  OnePath() {
    s_.data = &data_;
    s_.floor.rms_N = Eigen::Vector4d::Constant(0.5);
    s_.floor.of_names_N = s_.floor.rms_N;
  }
  void follow(int variant) {
    data_.recordings.push_back(
        identification::observe(robot_, identification::columnsOf(robot_),
                                identification::syntheticRecording(robot_, identification::syntheticModel(robot_),
                                                                   variant, 12.0, [] { return 0.0; }),
                                {}));
  }
  void leaves(double floors) { s_.rms_N = floors * s_.floor.rms_N; }
  const Candidate& named(const std::string& name) const {
    const auto found =
        std::find_if(candidates_.begin(), candidates_.end(), [&](const auto& c) { return c->name() == name; });
    return found == candidates_.end() ? *map_ : **found;
  }
  /// Whether an effect of this name, on the second actuator or all, is predicted elsewhere.
  bool transfers(const std::string& name) { return transfersOf(named(name), false); }
  bool transfersOf(const Candidate& candidate, bool doubted, const std::vector<std::string>& rivals = {}) {
    FoundEffect e;
    e.hypothesis.place = {&candidate, candidate.shared() ? -1 : 1};
    e.transfers = true;
    e.doubted = doubted;
    e.indistinguishable_from = rivals;
    s_.effects = {e};
    notes_.clear();
    holdBackOnePath(s_, notes_);
    return s_.effects.front().transfers;
  }

  /// Whether one of so many maps over velocity on one actuator is predicted elsewhere.
  bool oneTransfersOf(int maps, bool measured) {
    FoundEffect e;
    e.hypothesis.place = {velocity_map_.get(), 1};
    e.transfers = true;
    s_.effects.assign(static_cast<std::size_t>(maps), e);
    s_.floor.measured = measured;
    notes_.clear();
    holdBackOnePath(s_, notes_);
    return s_.effects.front().transfers;
  }

  const mechanism::Robot robot_ = identification::syntheticRobot();
  const CandidateList candidates_ = namedCandidates(robot_);
  const std::unique_ptr<Candidate> map_ = mapCandidate(robot_, "pose_theta_rad", 1, {0, 1, 2, 3, 4, 5, 6, 7});
  const std::unique_ptr<Candidate> velocity_map_ =
      mapCandidate(robot_, "velocity_2_m_per_s", 1, {0, 1, 2, 3, 4, 5, 6, 7});
  const std::unique_ptr<Candidate> time_map_ = mapCandidate(robot_, "time_s", 1, {0, 1, 2, 3, 4, 5, 6, 7});
  TraceData data_;
  Search s_;
  std::vector<std::string> notes_;
};

TEST_F(OnePath, LeavesOutForceFieldsOfAModelThatLeavesMuch) {
  follow(0);
  leaves(5.0);
  for (const char* field : {"spring", "nonlinear_spring", "map of the pose"}) {
    EXPECT_FALSE(transfers(field)) << field;
    ASSERT_EQ(notes_.size(), 1u);
    EXPECT_NE(notes_[0].find("Train on a second path"), std::string::npos) << notes_[0];
  }
  follow(0);
  EXPECT_FALSE(transfers("spring")) << "a repeat is no second path";
}

TEST_F(OnePath, LeavesOutAMapOfThePoseOnOneLegWhereAnotherLegLeavesMuch) {
  follow(0);
  leaves(1.5);
  EXPECT_TRUE(transfers("map of the pose"));
  s_.rms_N[3] = 5.0 * s_.floor.rms_N[3];  // the map is on the second
  EXPECT_FALSE(transfers("map of the pose")) << "what pulls at the platform loads all legs";
}

TEST_F(OnePath, LeavesOutWhatGoesWithTimeWhereAnotherLegLeavesMuch) {
  follow(0);
  leaves(1.5);
  EXPECT_TRUE(transfersOf(*time_map_, false));
  s_.rms_N[3] = 5.0 * s_.floor.rms_N[3];
  EXPECT_FALSE(transfersOf(*time_map_, false)) << "at the same time another path is elsewhere";
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("goes with time"), std::string::npos) << notes_[0];
  EXPECT_TRUE(transfersOf(named("gain_drift"), false)) << "a drift whose name is sure";
  EXPECT_FALSE(transfersOf(named("gain_drift"), true));
  EXPECT_TRUE(transfersOf(named("stribeck"), true)) << "doubted, and not of time";
  follow(1);
  EXPECT_TRUE(transfersOf(*time_map_, true)) << "two paths";
}

TEST_F(OnePath, LeavesOutWhatActsOnAllActuatorsAndMayBeSomethingElse) {
  follow(0);
  leaves(1.5);
  s_.floor.measured = true;
  const Candidate& dashpot = named("asymmetric_dashpot");
  EXPECT_TRUE(transfersOf(dashpot, true));
  s_.rms_N[3] = 5.0 * s_.floor.rms_N[3];
  EXPECT_FALSE(transfersOf(dashpot, true));
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("may be something else"), std::string::npos) << notes_[0];
  EXPECT_TRUE(transfersOf(dashpot, false)) << "its name is sure enough";
  EXPECT_FALSE(transfersOf(dashpot, false, {"viscoelastic_link"})) << "one of two names";
  follow(1);
  EXPECT_TRUE(transfersOf(dashpot, true)) << "two paths";
}

TEST_F(OnePath, LeavesOutWhatActsOnAllActuatorsAndHasTwoNamesWhereNoRepeatMeasuresTheFloor) {
  follow(0);
  leaves(1.5);
  EXPECT_FALSE(transfersOf(named("asymmetric_dashpot"), false, {"viscoelastic_link"}));
  EXPECT_TRUE(transfersOf(named("asymmetric_dashpot"), false));
}

TEST_F(OnePath, LeavesOutWhatMayBeUnnamedOnAnActuatorThatLeavesMuch) {
  follow(0);
  leaves(5.0);
  EXPECT_FALSE(transfersOf(named("delay"), false, {"drive_lag", "unnamed"}));
  EXPECT_TRUE(transfersOf(named("delay"), false, {"drive_lag"}));
  leaves(2.0);
  EXPECT_TRUE(transfersOf(named("delay"), false, {"drive_lag", "unnamed"}));
}

TEST_F(OnePath, KeepsWhatReachesTheNoiseFloorOrDependsOnMotion) {
  follow(0);
  leaves(2.0);
  EXPECT_TRUE(transfers("spring"));
  leaves(5.0);
  EXPECT_TRUE(transfers("stribeck"));
  EXPECT_TRUE(transfers("dashpot"));
  EXPECT_TRUE(transfers("load_dependent_friction"));
}

TEST_F(OnePath, LeavesOutSeveralMapsThatTogetherDoNotReachTheFloorOfRepeats) {
  follow(0);
  follow(0);
  leaves(2.5);
  EXPECT_TRUE(oneTransfersOf(1, true));
  EXPECT_FALSE(oneTransfersOf(2, true));
  ASSERT_EQ(notes_.size(), 2u);
  EXPECT_NE(notes_[0].find("one of 2 maps, which together leave 2.5 times the noise floor"), std::string::npos);
  EXPECT_TRUE(oneTransfersOf(2, false)) << "an estimated floor says too little";
  leaves(2.0);
  EXPECT_TRUE(oneTransfersOf(2, true));
  follow(1);
  leaves(2.5);
  EXPECT_TRUE(oneTransfersOf(2, true)) << "two paths";
}

TEST_F(OnePath, KeepsAMapThatExplainsNearlyAllAndLeavesOutThePatchesOnIt) {
  follow(0);
  leaves(2.5);
  FoundEffect e;
  e.hypothesis.place = {velocity_map_.get(), 1};
  for (const double explained_N : {3.9, 1.4}) {
    e.explained_rms_N = explained_N * Eigen::Vector4d::Unit(1);
    s_.effects.push_back(e);
  }
  s_.floor.measured = true;
  holdBackOnePath(s_, notes_);
  EXPECT_TRUE(s_.effects[0].transfers);
  EXPECT_FALSE(s_.effects[1].transfers);
  s_.effects[0].explained_rms_N[1] = 2.0;
  holdBackOnePath(s_, notes_);
  EXPECT_FALSE(s_.effects[0].transfers) << "of two that share it neither";
}

TEST_F(OnePath, KeepsForceFieldsThatTwoPathsShow) {
  follow(0);
  follow(1);
  leaves(5.0);
  EXPECT_TRUE(transfers("spring"));
}

TEST_F(OnePath, ThatTheBaselineDoesNotDescribeSaysNothingOfOthers) {
  const std::vector<std::string> doubts = {"The model does not describe these data at all"};
  follow(0);
  EXPECT_FALSE(isOnePathNotDescribed({}, data_.recordings));
  EXPECT_TRUE(isOnePathNotDescribed(doubts, data_.recordings));
  follow(0);
  EXPECT_TRUE(isOnePathNotDescribed(doubts, data_.recordings)) << "a repeat";
  follow(1);
  EXPECT_FALSE(isOnePathNotDescribed(doubts, data_.recordings)) << "two paths";
}

}  // namespace
}  // namespace knee_robot::tracing
