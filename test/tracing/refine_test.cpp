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
        const Line line = lineBetween(input, anchorsOf(anchors));
        pulls.emplace_back(line.lever.col(i).cwiseProduct(Eigen::VectorXd(3e3 * line.length_m.array())));
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

TEST_F(Refine, WhatLiesAtItsBoundKeepsNothingElseWhereItIs) {
  FoundEffect strap;  // acts from 0 m on, which cannot be less
  strap.hypothesis = named("one_sided_spring", {0.1, 0.15, 0.04, -0.14, 1.4, 0.0, 1.5, 0.002, 1.0});
  const std::vector<double> alone = refined({-0.35, 0.1, 0.0, 0.05}, {-0.2, 0.1, 0.0, 0.05});
  search_.effects.front().hypothesis.shape = {-0.2, 0.1, 0.0, 0.05};
  search_.effects.push_back(strap);
  refit(search_);
  refineShapes(search_);
  EXPECT_NEAR(alone[0], -0.35, 0.02);
  EXPECT_LT(search_.effects.front().hypothesis.shape[0], -0.25);
}

TEST_F(Refine, LeavesNoMoreThanBefore) {
  // A strap from above, and a curve over another distance that stands for it: wherever its anchor is far away the base
  // explains nearly all of its columns, which a fit without any pull would have in any size.
  const Anchors above{{0.1, 0.15, 1.4}, {0.04, -0.14, 0.0}};
  const Line line = lineBetween(data_.inputs.front(), above);
  const double least_m = line.length_m.minCoeff(), from_m = least_m + 0.3 * (line.length_m.maxCoeff() - least_m);
  base_.pull.setZero();
  add(effectRows(data_, named("one_sided_spring", {0.1, 0.15, 0.04, -0.14, 1.4, from_m, 1.5, 0.002, 1.0})) *
      Eigen::Vector2d(400.0, 20.0));
  FoundEffect e;
  e.hypothesis = named("nonlinear_spring", {0.0, -0.32, 0.0, -0.15});
  search_.effects.push_back(e);
  refit(search_);
  const Eigen::VectorXd before_N = search_.rms_N;
  refineShapes(search_);
  EXPECT_LT(search_.rms_N.cwiseQuotient(before_N).squaredNorm(), 4.0)
      << before_N.transpose() << " -> " << search_.rms_N.transpose();
}

}  // namespace
}  // namespace knee_robot::tracing
