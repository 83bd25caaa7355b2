// Friction by load and friction that differs each way, on the same actuators: two effects, or the direction of power flow?
#include "src/tracing/replace_pair.h"

#include <algorithm>

#include "src/tracing/library.h"
#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr double kDriving = 0.12, kDriven = 0.04, kPerLoad = 0.08, kHalfDifference_N = 6.0;

class ReplacePair : public SearchedMachine {
 protected:
  ReplacePair() {
    for (auto& candidate : namedCandidates(robot_)) {
      const std::string name = candidate->name();
      if (name == "power_flow_friction" || name == "load_dependent_friction" || name == "asymmetric_coulomb")
        kinds_.push_back(std::move(candidate));
    }
    library_.add(kinds_, data_);
    search_.library = &library_;
  }
  const Candidate& kind(const std::string& name) const {
    return **std::find_if(kinds_.begin(), kinds_.end(), [&](const auto& c) { return c->name() == name; });
  }
  /// Without a law of its own near rest.
  Hypothesis on(int actuator, const std::string& name) const {
    const Candidate& candidate = kind(name);
    return {{&candidate, actuator}, std::vector<double>(candidate.shapeParameters().size(), 0.0)};
  }
  void rubsByPowerFlow(int actuator) {
    const Eigen::MatrixXd rows = effectRows(data_, on(actuator, "power_flow_friction"));
    add(rows * Eigen::Vector4d(kDriving, kDriven, 0.0, 0.0));
  }
  void rubsByBoth(int actuator) {
    add(effectRows(data_, on(actuator, "load_dependent_friction")).col(0) * kPerLoad);
    add(effectRows(data_, on(actuator, "asymmetric_coulomb")).col(0) * kHalfDifference_N);
  }
  void findBoth(const std::vector<int>& actuators) {
    for (const char* name : {"load_dependent_friction", "asymmetric_coulomb"}) {
      for (const int actuator : actuators) {
        FoundEffect e;
        e.hypothesis = on(actuator, name);
        e.p = 0.004;
        search_.effects.push_back(e);
      }
    }
    refit(search_);
    replacePair(search_, &kind("asymmetric_coulomb"));
  }
  std::vector<std::string> left() const {
    std::vector<std::string> names;
    for (const FoundEffect& e : search_.effects)
      names.push_back(e.hypothesis.place.candidate->name());
    return names;
  }

  CandidateList kinds_;
  Library library_;
};

TEST_F(ReplacePair, FrictionByPowerFlowTakesThePlaceOfTheTwoThatStoodForIt) {
  for (const int actuator : {0, 1, 2})
    rubsByPowerFlow(actuator);
  findBoth({0, 1, 2});
  EXPECT_EQ(left(), std::vector<std::string>(3, "power_flow_friction"));
  ASSERT_EQ(search_.taken_out.size(), 1u);
  EXPECT_LT(search_.rms_N.cwiseQuotient(base_.noise_N).maxCoeff(), 1.2);
  for (const FoundEffect& e : search_.effects)
    EXPECT_NEAR(e.coefficients[0] + e.coefficients[2] * 50.0, kDriving, 0.03) << "at a load of 50 N";
}

TEST_F(ReplacePair, TwoThatAreThereStay) {
  for (const int actuator : {0, 1, 2})
    rubsByBoth(actuator);
  findBoth({0, 1, 2});
  EXPECT_EQ(left().size(), 6u);
  EXPECT_TRUE(search_.taken_out.empty());
}

TEST_F(ReplacePair, OnOneActuatorTwoEffectsAreNoLessLikelyThanOne) {
  rubsByPowerFlow(1);
  findBoth({1});
  EXPECT_EQ(left(), (std::vector<std::string>{"load_dependent_friction", "asymmetric_coulomb"}));
}

}  // namespace
}  // namespace knee_robot::tracing
