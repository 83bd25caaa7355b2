// A cable that hangs slack at one end is no straight spring.
#include "src/tracing/effects/common/line_effect.h"
#include "src/tracing/near_rest.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class NonlinearSpring : public SearchedMachine {};

TEST_F(NonlinearSpring, ExplainsACableThatHangsSlackWhereAStraightOneDoesNot) {
  const std::vector<double> anchors = {0.1, 0.1, 0.0, 0.05};
  Eigen::VectorXd force_N(data_.stack.size() * data_.stack.axes);
  for (int i = 0; i < data_.stack.axes; ++i) {
    std::vector<Eigen::MatrixXd> pulls;
    for (const EffectInput& input : data_.inputs) {
      const Line line = lineBetween(input, anchorsOf(anchors));
      const double slack_m = 0.5 * (line.length_m.minCoeff() + line.length_m.maxCoeff());
      pulls.emplace_back(
          line.lever.col(i).cwiseProduct(Eigen::VectorXd(4e3 * (line.length_m.array() - slack_m).max(0.0).square())));
    }
    force_N.segment(i * data_.stack.size(), data_.stack.size()) = gather(data_.stack, data_.recordings, pulls);
  }
  add(force_N);
  const Projection projection = projectModel(search_, {});
  const double straight = explained(data_, named("spring", anchors), projection, search_.rms_N);
  const double curved = explained(data_, named("nonlinear_spring", anchors), projection, search_.rms_N);
  EXPECT_GT(curved, 2.0 * straight);
  EXPECT_GT(curved, 0.5 * (projection.residual.squaredNorm() - static_cast<double>(projection.residual.size())));
}

}  // namespace
}  // namespace knee_robot::tracing
