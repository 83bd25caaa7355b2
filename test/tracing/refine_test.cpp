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

TEST_F(Refine, LeavesNoMoreThanBefore) {
  // A cushion that is touched in a part of the motion; the curve that stands for it has a column for every power, of
  // which the base explains nearly all wherever its anchor is far away.
  const Anchors cushion{{-0.11, -0.27, 0.0}, {0.04, -0.17, 0.0}};
  const Line line = lineBetween(data_.inputs.front(), 0, cushion);
  const double middle_m = 0.5 * (line.length_m.minCoeff() + line.length_m.maxCoeff());
  add(effectRows(data_, named("one_sided_spring", {-0.11, -0.27, 0.04, -0.17, 0.0, middle_m, 1.5, 0.002, 1.0})) *
      Eigen::Vector2d(400.0, 20.0));
  for (const std::vector<double>& beginning :
       {std::vector<double>{-0.073, 0.0, 0.028, 0.0}, {0.0, -0.32, 0.0, -0.15}}) {
    FoundEffect e;
    e.hypothesis = named("nonlinear_spring", beginning);
    search_.effects = {e};
    search_.rms_N = base_.noise_N;
    refit(search_);
    const Eigen::VectorXd before_N = search_.rms_N;
    refineShapes(search_);
    EXPECT_LT(search_.rms_N.cwiseQuotient(before_N).squaredNorm(), 4.0 + 1e-9)
        << before_N.transpose() << " -> " << search_.rms_N.transpose();
  }
}

}  // namespace
}  // namespace knee_robot::tracing
