// While shapes are rough, what bends more fits better; refined, the special case explains as much.
#include <algorithm>

#include "src/tracing/decide.h"
#include "src/tracing/library.h"
#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

const std::vector<double> kAnchors = {0.1, 0.1, 0.0, 0.05};

class Simplify : public SearchedMachine {
 protected:
  void compare(const std::string& general) {
    for (auto& candidate : namedCandidates(robot_)) {
      if (candidate->name() == general) special_ = candidate->generalizes();
      pair_.push_back(std::move(candidate));
    }
    pair_.erase(std::remove_if(pair_.begin(), pair_.end(),
                               [&](const auto& c) { return c->name() != general && c->name() != special_; }),
                pair_.end());
    library_.add(pair_, data_);
    search_.library = &library_;
  }

  /// The machine has this besides; what is left of the general effect that was found.
  std::string leftOf(const std::string& general, const Hypothesis& hidden, const Eigen::VectorXd& coefficients) {
    add(effectRows(data_, hidden) * coefficients);
    FoundEffect found;
    found.hypothesis = of(general);
    found.p = 0.004;
    search_.effects = {found};
    refit(search_);
    simplify(search_);
    return search_.effects.front().hypothesis.place.candidate->name();
  }
  /// The same of a curve over the distance.
  std::string leftOfCurve(const std::string& hidden, const Eigen::VectorXd& coefficients) {
    compare("nonlinear_spring");
    return leftOf("nonlinear_spring", of(hidden), coefficients);
  }

  const std::vector<std::string>& said() const { return search_.taken_out; }

  /// With the first of its shapes, or between points of this test.
  Hypothesis of(const std::string& name) const {
    for (const auto& candidate : pair_) {
      if (candidate->name() != name) continue;
      std::vector<double> shape = candidate->shapes(data_.inputs.front(), kActuator).front();
      if (candidate->shared()) std::copy(kAnchors.begin(), kAnchors.end(), shape.begin());
      return {{candidate.get(), candidate->shared() ? -1 : kActuator}, shape};
    }
    return {};
  }
  const std::string& special() const { return special_; }

 private:
  CandidateList pair_;
  std::string special_;
  Library library_;
};

/// A machine of its own.
class Alone : public Simplify {
 public:
  using Simplify::special;
  std::string leftOfSpecialCase(const std::string& general) {
    compare(general);
    const Hypothesis hidden = of(special());
    const Eigen::Index count = effectRows(data_, hidden).cols();
    const double size = effectRows(data_, hidden).cwiseAbs().maxCoeff();
    return leftOf(general, hidden, Eigen::VectorXd::Constant(count, 20.0 / size));
  }
  void TestBody() override {}
};

TEST_F(Simplify, ACurveOverTheDistanceThatIsStraightIsASpring) {
  EXPECT_EQ(leftOfCurve("spring", Eigen::Vector2d(800.0, 300.0)), "spring");
  EXPECT_NEAR(search_.effects.front().coefficients[0], 800.0, 40.0);
  ASSERT_EQ(said().size(), 1u);
  EXPECT_NE(said()[0].find("spring, a special case of it, explains as much"), std::string::npos) << said()[0];
}

TEST_F(Simplify, AStrapThatIsTautAllTheWayIsASpringBetweenTheSamePoints) {
  compare("one_sided_spring");
  EXPECT_EQ(leftOf("one_sided_spring", of("spring"), Eigen::Vector2d(800.0, 300.0)), "spring");
  const std::vector<double>& shape = search_.effects.front().hypothesis.shape;
  for (std::size_t k = 0; k < kAnchors.size(); ++k)
    EXPECT_NEAR(shape[k], kAnchors[k], 0.015) << "anchor " << k;  // five draws of the noise leave 10 to 13 mm
}

TEST_F(Simplify, FrictionThatGrowsWithTheLoadAlikeEitherWayIsLoadDependentWithAShapeOfItsOwn) {
  compare("power_flow_friction");
  EXPECT_EQ(leftOf("power_flow_friction", of("load_dependent_friction"), Eigen::VectorXd::Constant(1, 0.15)),
            "load_dependent_friction");
  EXPECT_EQ(search_.effects.front().hypothesis.shape.size(), of("load_dependent_friction").shape.size());
}

TEST_F(Simplify, EveryEffectThatGeneralizesAnotherMayBecomeIt) {
  std::vector<std::string> general;
  for (const auto& candidate : candidates_) {
    if (!candidate->generalizes().empty()) general.push_back(candidate->name());
  }
  ASSERT_GE(general.size(), 3u);
  for (const std::string& name : general) {
    SCOPED_TRACE(name);
    Alone alone;
    EXPECT_EQ(alone.leftOfSpecialCase(name), alone.special());
  }
}

TEST_F(Simplify, ACurveThatBendsStaysOne) {
  EXPECT_EQ(leftOfCurve("nonlinear_spring", Eigen::Vector4d(100.0, 800.0, 2e4, 0.0)), "nonlinear_spring");
  EXPECT_TRUE(said().empty());
}

}  // namespace
}  // namespace knee_robot::tracing
