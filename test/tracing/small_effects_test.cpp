#include <gtest/gtest.h>

#include "src/tracing/search.h"

namespace knee_robot::tracing {
namespace {

/// A candidate that is nothing but its name.
class Named : public Candidate {
 public:
  explicit Named(std::string name, bool local = false) : name_(std::move(name)), local_(local) {}
  bool local() const override { return local_; }
  std::string name() const override { return name_; }
  std::string sentence() const override { return {}; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {}; }
  Eigen::MatrixXd columns(const EffectInput&, int, const std::vector<double>&) const override { return {}; }

 private:
  std::string name_;
  bool local_;
};

/// What was found: effects that explain so many noise floors on the second of four actuators.
class SmallEffects : public testing::Test {
 protected:
  SmallEffects() { s.floor.rms_N = Eigen::Vector4d(9.0, 0.5, 9.0, 9.0); }
  void found(const Candidate& candidate, double floors, bool transfers = true) {
    FoundEffect e;
    e.hypothesis.place.candidate = &candidate;
    e.hypothesis.place.actuator = 1;
    e.explained_rms_N = Eigen::Vector4d(0.0, floors * s.floor.rms_N[1], 0.0, 0.0);
    e.coefficients = Eigen::VectorXd::Ones(1);
    e.transfers = transfers;
    s.effects.push_back(e);
  }
  std::vector<std::string> left() const {
    std::vector<std::string> out;
    for (const FoundEffect& e : s.effects)
      out.push_back(e.hypothesis.place.candidate->name());
    return out;
  }
  using Names = std::vector<std::string>;

  Named ripple{"screw_ripple"}, map{"unnamed"}, stribeck{"stribeck"}, drift{"thermal_drift"},
      push{"external_force", true};
  Search s;
  std::vector<std::string> rejected;
};

TEST_F(SmallEffects, ARippleBelowTheFloorIsLeftOutBesideEffectsThatStay) {
  found(stribeck, 0.8);
  found(ripple, 0.9);
  EXPECT_EQ(leaveOutSmall(s, false, rejected), 1);
  EXPECT_EQ(left(), Names{"stribeck"}) << "few shapes: it may be small";
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_EQ(rejected[0].rfind("screw_ripple on actuator 2: is no larger than the noise floor", 0), 0u) << rejected[0];
}

TEST_F(SmallEffects, HeldBackPositionsSayNothingOfWhatGoesWithTime) {
  found(drift, 0.9);
  EXPECT_EQ(leaveOutSmall(s, true, rejected), 1);
}

TEST_F(SmallEffects, APushBelowTheFloorIsNone) {
  found(push, 0.9, false);
  found(push, 1.2, false);
  EXPECT_EQ(leaveOutSmall(s, true, rejected), 1);
  EXPECT_EQ(left(), Names{"external_force"});
}

TEST_F(SmallEffects, AMapNeedsTwiceTheFloor) {
  found(map, 1.9);
  found(map, 2.1);
  found(ripple, 1.1);
  EXPECT_EQ(leaveOutSmall(s, false, rejected), 1);
  EXPECT_EQ(left(), (Names{"unnamed", "screw_ripple"}));
}

TEST_F(SmallEffects, WhatSurelyHelpsElsewhereStaysHoweverSmall) {
  found(ripple, 0.5);
  EXPECT_EQ(leaveOutSmall(s, true, rejected), 0);
  EXPECT_EQ(left(), Names{"screw_ripple"});
}

TEST_F(SmallEffects, WhatIsNotPredictedElsewhereIsNotKeptByWhatTheOthersSaveThere) {
  found(stribeck, 3.0);
  found(ripple, 0.5, false);
  EXPECT_EQ(leaveOutSmall(s, true, rejected), 1);
  EXPECT_EQ(left(), Names{"stribeck"});
}

}  // namespace
}  // namespace knee_robot::tracing
