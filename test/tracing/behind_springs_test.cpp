// Where the platform is when its legs give.
#include "src/tracing/behind_springs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/recording/filter.h"
#include "src/tracing/length_response.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

constexpr double kStiff = 4e6;     // N/m: some thousandths are left to gravity
constexpr double kDamping = 0.05;  // of the springs: what it does to slow loads is within the bounds below

class BehindSprings : public testing::Test {
 protected:
  BehindSprings() { setModel(input_, columns_, parameters()); }

  /// Every leg would be longer by this sine if it moved slowly.
  Eigen::MatrixXd sine(double hz) const {
    Eigen::MatrixXd longer(input_.samples(), 4);
    for (int n = 0; n < input_.samples(); ++n)
      longer.row(n).setConstant(1e-4 * std::sin(2.0 * M_PI * hz * n * input_.signals().period_s));
    return longer;
  }
  double largestChange(double stiffness_N_per_m, double hz) const {
    return changeBehindSprings(input_, {mechanism::Vector4::Constant(stiffness_N_per_m), kDamping}, sine(hz))
        .bottomRows(input_.samples() / 2)
        .cwiseAbs()
        .maxCoeff();
  }

  const mechanism::Robot robot_ = identification::syntheticRobot();
  const std::vector<identification::Column> columns_ = identification::columnsOf(robot_);
  const identification::Observation observation_ = identification::observe(
      robot_, columns_,
      identification::syntheticRecording(robot_, identification::syntheticModel(robot_), 0, 20.0, [] { return 0.0; }),
      {});
  EffectInput input_ = effectInput(robot_, observation_, std::vector<dynamics::FrictionLaw>(4), 0, 1);

 private:
  Eigen::VectorXd parameters() const {
    const dynamics::Model truth = identification::syntheticModel(robot_);
    Eigen::VectorXd out(static_cast<Eigen::Index>(columns_.size()));
    for (std::size_t c = 0; c < columns_.size(); ++c)
      out[static_cast<Eigen::Index>(c)] = identification::parameterValue(truth, columns_[c].name) / columns_[c].newtons;
    return out;
  }
};

TEST_F(BehindSprings, IsStiffnessTimesLengthAndMassTimesItsAccelerationWhereSpringsAreStiff) {
  const Eigen::MatrixXd longer = sine(0.5),
                        change = changeBehindSprings(input_, {mechanism::Vector4::Constant(kStiff), kDamping}, longer);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(input_.samples(), 4);
  const Eigen::VectorXd faster = recording::secondDerivative(longer.col(0), input_.signals().period_s);
  for (int n = 0; n < input_.samples(); ++n) {
    const LengthResponse::Knot knot = input_.by_lengths->at(input_, n);
    if (!knot.known) continue;
    expected.row(n) =
        (knot.stiffness * longer.row(n).transpose() + knot.mass * mechanism::Vector4::Constant(faster[n])).transpose();
  }
  const Eigen::Index from = 200, many = input_.samples() - 400;  // derivatives at the ends are one-sided
  EXPECT_LT((change - expected).middleRows(from, many).norm(), 0.02 * expected.middleRows(from, many).norm());
}

TEST_F(BehindSprings, AreFollowedSlowlyAndNotFarBeyondTheResonance) {
  const double soft = 3e4;  // a sixth of which gravity itself takes up
  EXPECT_NEAR(largestChange(soft, 0.3), largestChange(kStiff, 0.3), 0.3 * largestChange(kStiff, 0.3));
  EXPECT_LT(largestChange(soft, 20.0), 0.2 * largestChange(kStiff, 20.0));
}

}  // namespace
}  // namespace knee_robot::tracing
