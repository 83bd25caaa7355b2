// Shapes of what was found are refined together, wherever they begin.
#include "src/tracing/refine.h"

#include "src/tracing/effects/common/line_effect.h"
#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class Refine : public SearchedMachine {
 protected:
  /// The machine has a spring between these points; the search has found it beginning at others.
  std::vector<double> refined(const std::vector<double>& anchors, const std::vector<double>& beginning) {
    const Hypothesis there = named("spring", anchors);
    Eigen::VectorXd force_N(data_.stack.size() * data_.stack.axes);
    for (int i = 0; i < data_.stack.axes; ++i) {
      std::vector<Eigen::MatrixXd> pulls;
      for (const EffectInput& input : data_.inputs) {
        const Line line = lineBetween(input, i, anchorsOf(anchors));
        pulls.emplace_back(line.lever.cwiseProduct(Eigen::VectorXd(3e3 * line.length_m.array())));
      }
      force_N.segment(i * data_.stack.size(), data_.stack.size()) = gather(data_.stack, data_.recordings, pulls);
    }
    add(force_N);
    FoundEffect e;
    e.hypothesis = named("spring", beginning);
    search_.effects.push_back(e);
    refit(search_);
    refineShapes(search_);
    return search_.effects.front().hypothesis.shape;
  }
};

TEST_F(Refine, AnAnchorMayLieOnEitherSideOfTheOriginAndFartherThanItMovesAtOnce) {
  const std::vector<double> shape = refined({-0.35, 0.1, 0.0, 0.05}, {-0.02, 0.1, 0.0, 0.05});
  EXPECT_NEAR(shape[0], -0.35, 0.02);
  EXPECT_NEAR(shape[1], 0.1, 0.02);
}

}  // namespace
}  // namespace knee_robot::tracing
