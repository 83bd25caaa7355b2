// While shapes are rough, what bends more fits better; refined, the special case explains as much.
#include "src/tracing/library.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

const std::vector<double> kAnchors = {0.1, 0.1, 0.0, 0.05};

class Simplify : public SearchedMachine {
 protected:
  Simplify() {
    for (auto& candidate : namedCandidates(robot_)) {
      if (candidate->name() == "spring" || candidate->name() == "nonlinear_spring")
        pair_.push_back(std::move(candidate));
    }
    library_.add(pair_, data_);
    search_.library = &library_;
  }

  /// The machine has this besides; what is left of a curve over the distance that was found.
  std::string leftOfCurve(const std::string& hidden, const Eigen::VectorXd& coefficients) {
    add(effectRows(data_, of(hidden)) * coefficients);
    FoundEffect found;
    found.hypothesis = of("nonlinear_spring");
    found.p = 0.004;
    search_.effects = {found};
    refit(search_);
    simplify(search_);
    return search_.effects.front().hypothesis.place.candidate->name();
  }

  const std::vector<std::string>& said() const { return search_.taken_out; }

 private:
  Hypothesis of(const std::string& name) const {
    for (const auto& candidate : pair_) {
      if (candidate->name() == name) return {{candidate.get(), -1}, kAnchors};
    }
    return {};
  }

  CandidateList pair_;
  Library library_;
};

TEST_F(Simplify, ACurveOverTheDistanceThatIsStraightIsASpring) {
  EXPECT_EQ(leftOfCurve("spring", Eigen::Vector2d(800.0, 300.0)), "spring");
  EXPECT_NEAR(search_.effects.front().coefficients[0], 800.0, 40.0);
  ASSERT_EQ(said().size(), 1u);
  EXPECT_NE(said()[0].find("spring, a special case of it, explains as much"), std::string::npos) << said()[0];
}

TEST_F(Simplify, ACurveThatBendsStaysOne) {
  EXPECT_EQ(leftOfCurve("nonlinear_spring", Eigen::Vector4d(100.0, 800.0, 2e4, 0.0)), "nonlinear_spring");
  EXPECT_TRUE(said().empty());
}

}  // namespace
}  // namespace knee_robot::tracing
