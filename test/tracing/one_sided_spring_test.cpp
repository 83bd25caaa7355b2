// A strap from the ceiling, and a stop that is touched, act on one side of a length.
#include "src/tracing/effects/common/line_effect.h"
#include "src/tracing/near_rest.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class OneSidedSpring : public SearchedMachine {
 protected:
  /// Tied to a point above the platform, slack in half of the motion.
  std::vector<double> strap(double side) const {
    const Anchors anchors{{0.1, 0.1, 1.4}, {0.0, 0.05, 0.0}};
    const Line line = lineBetween(data_.inputs.front(), anchors);
    const double middle_m = 0.5 * (line.length_m.minCoeff() + line.length_m.maxCoeff());
    return {0.1, 0.1, 0.0, 0.05, 1.4, middle_m, 1.3, 0.002, side};
  }
  Eigen::MatrixXd columns(const std::vector<double>& shape) const {
    return named("one_sided_spring", shape).place.candidate->columns(data_.inputs.front(), 1, shape);
  }
};

TEST_F(OneSidedSpring, ExplainsAStrapWhereACurveBetweenPointsOfTheSameHeightDoesNot) {
  const Hypothesis hidden = named("one_sided_spring", strap(1.0));
  add(effectRows(data_, hidden) * Eigen::Vector2d(80.0, 15.0));
  const Projection projection = projectModel(search_, {});
  const double curved = explained(data_, named("nonlinear_spring", {0.1, 0.1, 0.0, 0.05}), projection, search_.rms_N);
  const double own = explained(data_, hidden, projection, search_.rms_N);
  EXPECT_GT(own, 1.5 * curved);
  EXPECT_GT(own, 0.5 * (projection.residual.squaredNorm() - static_cast<double>(projection.residual.size())));
}

TEST_F(OneSidedSpring, ActsOnItsSideAlone) {
  const Eigen::MatrixXd pulls = columns(strap(1.0)), pushes = columns(strap(-1.0));
  EXPECT_TRUE(pulls.col(0).cwiseProduct(pushes.col(0)).isZero(0.0));
  EXPECT_GT(pulls.col(0).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_GT(pushes.col(0).cwiseAbs().maxCoeff(), 0.0);
}

TEST_F(OneSidedSpring, LosesNoMoreThanItsShareAndKeepsItAtRest) {
  const Eigen::MatrixXd pulls = columns(strap(1.0));
  EXPECT_TRUE((pulls.col(1).array().abs() <= pulls.col(0).array().abs() + 1e-12).all());
  identification::Observation stands = data_.recordings.front();
  EffectInput input = data_.inputs.front();
  Eigen::Index taut = 0;
  pulls.col(0).cwiseAbs().maxCoeff(&taut);
  for (std::size_t n = static_cast<std::size_t>(taut); n < stands.motion.motion.size(); ++n) {
    stands.motion.motion[n] = stands.motion.motion[static_cast<std::size_t>(taut)];
    stands.motion.motion[n].pose_velocity.setZero();
    input.rotation[n] = input.rotation[static_cast<std::size_t>(taut)];
    input.force_per_pose_force[n] = input.force_per_pose_force[static_cast<std::size_t>(taut)];
  }
  input.observation = &stands;
  const std::vector<double> shape = strap(1.0);
  const Eigen::MatrixXd at_rest = named("one_sided_spring", shape).place.candidate->columns(input, kActuator, shape);
  EXPECT_GT(std::abs(at_rest(taut, 1)), 0.0);
  EXPECT_NEAR(at_rest(input.samples() - 1, 1), at_rest(taut + 1, 1), 1e-9);
}

}  // namespace
}  // namespace knee_robot::tracing
