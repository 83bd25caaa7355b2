// A supply that all drives hang on.
#include <cmath>

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class SupplySag : public SearchedMachine {
 protected:
  /// By one share for all drives, as where their motors are alike.
  Eigen::MatrixXd lost(const std::vector<double>& shape) const {
    const EffectInput& input = data_.inputs.front();
    Eigen::MatrixXd out(input.samples(), input.axes());
    for (int i = 0; i < input.axes(); ++i)
      out.col(i) = effectColumns(input, named("supply_sag", shape), i).rowwise().sum();
    return out;
  }
};

TEST_F(SupplySag, TakesTheSameShareOfEveryDrivesForceMoreTheMoreTheyGiveTogether) {
  const Eigen::MatrixXd& needed = data_.inputs.front().needed_N;
  const double half_N2 = needed.rowwise().squaredNorm().mean();
  const Eigen::MatrixXd loss = lost({half_N2, 0.003, 0.0});
  for (const int n : {100, 700, 1300}) {
    const double taken_N2 = needed.row(n).squaredNorm(), share = taken_N2 / (taken_N2 + half_N2);
    EXPECT_LT((loss.row(n) - share * needed.row(n)).norm(), 0.02 * needed.row(n).norm());
  }
}

TEST_F(SupplySag, LosesByEveryDriveForItself) {
  const EffectInput& input = data_.inputs.front();
  const Eigen::MatrixXd& needed = input.needed_N;
  const double half_N2 = needed.rowwise().squaredNorm().mean();
  const Hypothesis sag = named("supply_sag", {half_N2, 0.003, 0.0});
  ASSERT_EQ(sag.place.candidate->coefficients(input).size(), 4u);
  const Eigen::MatrixXd by_drive = effectColumns(input, sag, kActuator);
  for (const int n : {100, 700, 1300}) {
    const Eigen::RowVectorXd share = needed.row(n).array().square() / (needed.row(n).squaredNorm() + half_N2);
    EXPECT_LT((by_drive.row(n) - needed(n, kActuator) * share).norm(), 0.02 * std::abs(needed(n, kActuator)));
  }
}

TEST_F(SupplySag, CountsTheWorkThatDrivesDoAndNothingBelowNothing) {
  const EffectInput& input = data_.inputs.front();
  const Eigen::MatrixXd &needed = input.needed_N, &velocity = input.signals().velocity_m_per_s;
  const double half_N2 = needed.rowwise().squaredNorm().mean(), work = 2000.0;
  const Eigen::MatrixXd loss = lost({half_N2, 0.003, work});
  int fed_back = 0;
  for (int n = 1; n < input.samples(); ++n) {
    const double squares = needed.row(n).squaredNorm(), all = squares + work * needed.row(n).dot(velocity.row(n));
    const double share = loss.row(n).dot(needed.row(n)) / squares;
    EXPECT_GE(share, 0.0) << "sample " << n;
    fed_back += all < 0.5 * squares;
    if (all <= 0.1 * squares) continue;
    EXPECT_NEAR(share, all / (all + half_N2), 0.1) << "sample " << n;
  }
  EXPECT_GT(fed_back, 10) << "the platform sinks at times";
}

TEST_F(SupplySag, FollowsWhatIsTakenWithItsLag) {
  const Eigen::MatrixXd& needed = data_.inputs.front().needed_N;
  const double half_N2 = needed.rowwise().squaredNorm().mean();
  const auto variation = [&](double lag_s) {
    const Eigen::ArrayXd share = lost({half_N2, lag_s, 0.0}).col(kActuator).array() / needed.col(kActuator).array();
    return std::sqrt((share - share.mean()).square().mean());
  };
  EXPECT_LT(variation(1.0), 0.6 * variation(0.003));
}

TEST_F(SupplySag, LooksAtForcesWithoutWhatTheSupplyLoses) {
  const Hypothesis sag = named("supply_sag", {1e4, 0.003, 0.0});
  const Eigen::MatrixXd needed = data_.inputs.front().needed_N;
  const SurrogateModel model = {base_.parameters, {sag}, {Eigen::VectorXd::Constant(4, 0.4)}};
  (void)settleForces(data_.inputs.front(), base_.columns, base_.parameters, model);
  EXPECT_LT((data_.inputs.front().needed_N - needed).norm(), 1e-9 * needed.norm());
  EXPECT_GT((data_.inputs.front().force_N - needed).norm(), 0.05 * needed.norm());
}

}  // namespace
}  // namespace knee_robot::tracing
