// What is solved from triangles and factors that are there already is what a fit of its own gives.
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class JointlyFitted : public SearchedMachine {};

TEST_F(JointlyFitted, LeavesWithoutAnEffectWhatAProblemWithoutItLeaves) {
  const std::unique_ptr<Candidate> map = mapCandidate(robot_, "pose_x_m", kActuator, {0, 1, 2, 3, 4, 5, 6, 7});
  const Eigen::Index rows = data_.base_rows.rows();
  const Eigen::MatrixXd hats = Eigen::MatrixXd::Random(rows, 8), other_hats = Eigen::MatrixXd::Random(rows, 8);
  const Hypothesis effect = {{map.get(), kActuator}, {}};
  const JointProblem both(data_, base_, base_.noise_N, {effect, effect}, {hats, other_hats});
  const Eigen::VectorXd own = JointProblem(data_, base_, base_.noise_N, {effect}, {other_hats}).heldBack();
  const Eigen::VectorXd left = both.heldBackWithout(0);
  ASSERT_EQ(left.size(), data_.stack.blocks);
  EXPECT_LT((left - own).norm(), 1e-9 * own.norm());
  EXPECT_GT((both.heldBack() - own).norm(), 1e-6 * own.norm());
  EXPECT_LT((both.heldBack() - both.fit().held_back).norm(), 1e-12 * own.norm());
}

/// What acts on one actuator in the first block only, beside a friction that acts everywhere.
class BesideWhatIsInOneBlock : public JointlyFitted {
 protected:
  BesideWhatIsInOneBlock() {
    const Eigen::Index first = kActuator * data_.stack.size(), size = data_.stack.size();
    always_.col(0).segment(first, size).setRandom();
    for (Eigen::Index row = 0; row < size; ++row)
      once_[first + row] = data_.stack.picks[static_cast<std::size_t>(row)].block == 0 ? 1.0 : 0.0;
    quiet_ = JointProblem(data_, base_, base_.noise_N, {friction_}, {always_}).heldBack()[0];
    data_.force_rows += 50.0 * once_;
  }
  JointProblem beside(const std::string& name, const std::vector<double>& shape) const {
    const Hypothesis effect = named(name, shape);
    const Eigen::Index columns =
        static_cast<Eigen::Index>(effect.place.candidate->coefficients(data_.inputs.front()).size());
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(once_.size(), columns);
    rows.col(0) = once_;
    return {data_, base_, base_.noise_N, {effect, friction_}, {rows, always_}};
  }
  Hypothesis friction_ = named("stribeck", {0.007, 1.0, 0.0});
  Eigen::VectorXd once_ = Eigen::VectorXd::Zero(data_.base_rows.rows());
  Eigen::MatrixXd always_ = Eigen::MatrixXd::Zero(data_.base_rows.rows(), 1);
  double quiet_ = 0.0;  ///< squares that the first block leaves when it is left out, without it
};

TEST_F(BesideWhatIsInOneBlock, APushIsKnownAlsoWhereThatIsLeftOut) {
  const JointProblem problem = beside("external_force", {1.0, 0.5});
  EXPECT_NEAR(problem.fit().coefficients[0][0], 50.0, 5.0);
  EXPECT_LT(problem.heldBack()[0], 2.0 * quiet_) << "from what is left outside its size would be anything";
  EXPECT_LT(problem.heldBackWithout(1)[0], 2.0 * quiet_);
  EXPECT_GT(problem.heldBackWithout(0)[0], 10.0 * quiet_) << "the fifty newtons themselves";
}

TEST_F(BesideWhatIsInOneBlock, OfAnyOtherEffectNothingIsKnownThere) {
  const JointProblem problem = beside("stribeck", {0.02, 1.0, 0.0});
  const double unknown = problem.heldBackWithout(0)[0];
  EXPECT_GT(unknown, 10.0 * quiet_);
  EXPECT_NEAR(problem.heldBack()[0], unknown, 0.01 * unknown) << "no size that rounding says";
}

class ProjectedOnto : public ::testing::Test {
 protected:
  /// More rows than one piece has; the last column is a sum of others: it adds no direction.
  ProjectedOnto() : columns_(Eigen::MatrixXd::Random(3000, 30)), force_(Eigen::VectorXd::Random(3000)) {
    columns_.col(29) = columns_.col(0) + 1e3 * columns_.col(7);
  }

  Eigen::MatrixXd columns_;
  Eigen::VectorXd force_;
};

TEST_F(ProjectedOnto, DependentColumnsGiveAnOrthonormalBasisOfTheirRank) {
  const Projection p = project(columns_, force_);
  ASSERT_EQ(p.q.cols(), 29);
  EXPECT_LT((p.q.transpose() * p.q - Eigen::MatrixXd::Identity(29, 29)).norm(), 1e-12);
  EXPECT_LT((columns_ - p.q * (p.q.transpose() * columns_)).norm(), 1e-11 * columns_.norm());
  EXPECT_LT((columns_.transpose() * p.residual).norm(), 1e-10 * columns_.norm() * force_.norm());
}

TEST_F(ProjectedOnto, FewerRowsThanColumnsTheForceIsAllExplained) {
  EXPECT_LT(project(columns_.topRows(20), force_.head(20)).residual.norm(), 1e-12 * force_.head(20).norm());
}

TEST_F(ProjectedOnto, NoColumnsNothingIsExplained) {
  EXPECT_EQ(project(columns_.leftCols(0), force_).residual, force_);
}

TEST_F(ProjectedOnto, SomeColumnsLeftOutTheOthersTakeWhatTheyTakeAlone) {
  const Eigen::VectorXd pull = Eigen::VectorXd::Constant(5, 30.0);
  const Projector all(columns_, force_, pull);
  Eigen::MatrixXd others(3000, 22);
  others << columns_.leftCols(10), columns_.rightCols(12);
  const Projection alone = project(others, force_, pull), left = all.without(10, 8);
  ASSERT_EQ(left.q.cols(), alone.q.cols());
  EXPECT_LT((left.residual - alone.residual).norm(), 1e-11 * force_.norm());
  EXPECT_LT(
      (left.q * left.q.transpose() * columns_.col(12) - alone.q * (alone.q.transpose() * columns_.col(12))).norm(),
      1e-11 * columns_.col(12).norm());
}

TEST_F(ProjectedOnto, WhatIsLeftComesWithoutABasis) {
  const Eigen::VectorXd pull = Eigen::VectorXd::Constant(5, 30.0);
  EXPECT_LT((leftBy(columns_, force_, pull) - project(columns_, force_, pull).residual).norm(), 1e-11 * force_.norm());
  EXPECT_LT((leftBy(columns_, force_) - project(columns_, force_).residual).norm(), 1e-11 * force_.norm());
}

}  // namespace
}  // namespace knee_robot::tracing
