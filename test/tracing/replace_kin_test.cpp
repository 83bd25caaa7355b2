// A strap that is found after a curve which stood for it takes the place of both.
#include "src/tracing/replace_kin.h"

#include <algorithm>

#include "src/tracing/effects/common/line_effect.h"
#include "src/tracing/library.h"
#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

const std::vector<double> kStrap = {0.1, 0.1, 0.0, 0.05}, kSpring = {-0.3, -0.2, 0.1, -0.1};

class ReplaceKin : public SearchedMachine {
 protected:
  ReplaceKin() {
    for (auto& candidate : namedCandidates(robot_)) {
      if (candidate->name().find("spring") != std::string::npos) springs_.push_back(std::move(candidate));
    }
    library_.add(springs_, data_);
    search_.library = &library_;
  }
  /// Slack in half of the motion.
  std::vector<double> strap() const {
    const Line line = lineBetween(data_.inputs.front(), anchorsOf(kStrap));
    const double middle_m = 0.5 * (line.length_m.minCoeff() + line.length_m.maxCoeff());
    return {kStrap[0], kStrap[1], kStrap[2], kStrap[3], 0.0, middle_m, 1.5, 0.002, 1.0};
  }
  Hypothesis of(const std::string& name, std::vector<double> shape) const {
    const auto candidate =
        std::find_if(springs_.begin(), springs_.end(), [&](const auto& c) { return c->name() == name; });
    return {{candidate->get(), -1}, std::move(shape)};
  }
  void found(const Hypothesis& h) {
    FoundEffect e;
    e.hypothesis = h;
    e.p = 0.004;
    search_.effects.push_back(e);
  }
  std::vector<std::string> left() const {
    std::vector<std::string> names;
    for (const FoundEffect& e : search_.effects)
      names.push_back(e.hypothesis.place.candidate->name());
    return names;
  }

  Library library_;

 private:
  CandidateList springs_;
};

TEST_F(ReplaceKin, AStrapTakesThePlaceOfTheCurveThatStoodForIt) {
  add(effectRows(data_, of("one_sided_spring", strap())) * Eigen::Vector2d(60.0, 5.0));
  found(of("nonlinear_spring", kStrap));
  std::vector<double> what_the_curve_left = strap();
  what_the_curve_left[0] = -0.3;
  found(of("one_sided_spring", what_the_curve_left));
  refit(search_);
  replaceKin(search_, search_.effects.back().hypothesis.place);
  EXPECT_EQ(left(), std::vector<std::string>{"one_sided_spring"});
  ASSERT_EQ(search_.taken_out.size(), 1u);
  EXPECT_NE(search_.taken_out[0].find("nonlinear_spring"), std::string::npos) << search_.taken_out[0];
  EXPECT_LT(search_.rms_N.cwiseQuotient(base_.noise_N).maxCoeff(), 1.3);
}

TEST_F(ReplaceKin, AStrapBesideASpringElsewhereStaysBesideIt) {
  add(effectRows(data_, of("one_sided_spring", strap())) * Eigen::Vector2d(60.0, 5.0));
  add(effectRows(data_, of("nonlinear_spring", kSpring)) * Eigen::Vector4d(20.0, 300.0, 4e3, 0.0));
  found(of("nonlinear_spring", kSpring));
  found(of("one_sided_spring", strap()));
  refit(search_);
  replaceKin(search_, search_.effects.back().hypothesis.place);
  EXPECT_EQ(left(), (std::vector<std::string>{"nonlinear_spring", "one_sided_spring"}));
}

}  // namespace
}  // namespace knee_robot::tracing
