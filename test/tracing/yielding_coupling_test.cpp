// A coupling that gives, of one leg, against machines whose leg ends in a spring, exactly.
#include "src/tracing/effects/common/yielding_coupling.h"

#include <gtest/gtest.h>

#include "knee_robot/recording/filter.h"
#include "test/tracing/soft_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr int kSoftLeg = 1;
constexpr double kSpring_N_per_m = 5e3;  ///< some 30 N wind it by 6 mm, and what hangs on it swings at some 4 Hz

mechanism::Vector4 softLeg(double spring_N_per_m) {
  mechanism::Vector4 compliance = mechanism::Vector4::Zero();
  compliance[kSoftLeg] = 1.0 / spring_N_per_m;
  return compliance;
}

/// What a leg that gives adds to what the stiff machine's forces lack (friction's hysteresis between samples), below 4 Hz.
class YieldingCouplingOfOneLeg : public testing::Test {
 protected:
  static Eigen::MatrixXd slow(Eigen::MatrixXd force_N, const EffectInput& in) {
    recording::ZeroPhaseLowPass(4.0, 1.0 / in.signals().period_s).applyToColumns(force_N);
    return force_N.middleRows(300, 3400);
  }

  const mechanism::Robot robot_ = identification::syntheticRobot();
  const SoftRecording soft_{robot_, softLeg(kSpring_N_per_m)}, stiff_{robot_, mechanism::Vector4::Zero()};
};

TEST_F(YieldingCouplingOfOneLeg, ChangesWhatEveryLegCarriesAsTheExactMachineHasIt) {
  // Its friction and its rotor are on the encoder's side.
  const Eigen::MatrixXd said = slow(changeByCoupling(soft_.input, kSoftLeg, {kSpring_N_per_m, 0.0, 0.05}), soft_.input);
  const Eigen::MatrixXd given = slow(soft_.lacking_N(), soft_.input) - slow(stiff_.lacking_N(), stiff_.input);
  for (int i = 0; i < 4; ++i) {
    const double size = given.col(i).norm() / std::sqrt(static_cast<double>(given.rows()));
    std::cout << "leg " << i + 1 << ": " << size << " N, not said "
              << (given - said).col(i).norm() / given.col(i).norm() << " of it\n";
    EXPECT_GT(size, 0.3) << "leg " << i + 1 << " feels it";
    const double most = i == kSoftLeg ? 0.15 : 0.03;  // on its own friction takes part
    EXPECT_LT((given - said).col(i).norm(), most * given.col(i).norm()) << "leg " << i + 1;
  }
}

TEST_F(YieldingCouplingOfOneLeg, OfAStiffSpringChangesNothing) {
  const Eigen::MatrixXd said = slow(changeByCoupling(stiff_.input, kSoftLeg, {1e8, 0.0, 0.01}), stiff_.input);
  EXPECT_LT(said.cwiseAbs().maxCoeff(), 0.05);
}

TEST(Trace, NamesACouplingSoSoftThatItMovesTheOtherLegs) {
  const mechanism::Robot robot = identification::syntheticRobot();
  const std::vector<recording::Recording> recordings = {SoftMachine(robot, softLeg(kSpring_N_per_m), 0).recorded(0),
                                                        SoftMachine(robot, softLeg(kSpring_N_per_m), 1).recorded(1)};
  TraceOptions options;
  options.surrogates = 5;
  const TraceResult result = trace(
      robot, recordings,
      identification::observeAll(robot, identification::columnsOf(robot), recordings, options.observation), options);
  std::cout << "before " << result.before_rms_N.transpose() << " after " << result.after_rms_N.transpose() << " N\n";
  for (const FoundEffect& found : result.effects)
    std::cout << found.hypothesis.place.candidate->name() << " on " << found.hypothesis.place.actuator << ", "
              << found.hypothesis.shape.front() << ": " << found.coefficients.transpose() << "\n";
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& e = result.effects[0];
  EXPECT_EQ(e.hypothesis.place.candidate->name(), "flexible_coupling");
  EXPECT_EQ(e.hypothesis.place.actuator, kSoftLeg);
  EXPECT_NEAR(e.hypothesis.shape[0], kSpring_N_per_m, 0.1 * kSpring_N_per_m);
  EXPECT_NEAR(e.coefficients[0], 1.0, 0.1) << "whole";
}

// Twenty kilonewtons a metre: the baseline takes most of it up until the share of the forward model is pulled to one.
TEST(Trace, FindsTheStiffnessOfEachOfFourSoftLegs) {
  const mechanism::Vector4 stiffness(18e3, 16e3, 22e3, 28e3);
  const TraceResult result = tracedSoft(identification::syntheticRobot(), stiffness.cwiseInverse());
  for (const FoundEffect& found : result.effects)
    std::cout << found.hypothesis.place.candidate->name() << " on " << found.hypothesis.place.actuator << ": "
              << Eigen::Map<const Eigen::RowVectorXd>(found.hypothesis.shape.data(),
                                                      static_cast<Eigen::Index>(found.hypothesis.shape.size()))
              << ", " << found.coefficients.transpose() << "\n";
  std::cout << "before " << result.before_rms_N.transpose() << " after " << result.after_rms_N.transpose() << " N\n";
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& e = result.effects[0];
  EXPECT_EQ(e.hypothesis.place.candidate->name(), "flexible_coupling");
  EXPECT_EQ(e.hypothesis.place.actuator, -1);
  for (int j = 0; j < 4; ++j)
    EXPECT_NEAR(e.hypothesis.shape[static_cast<std::size_t>(j) + 1], stiffness[j], 0.15 * stiffness[j])
        << "leg " << j + 1;
  EXPECT_NEAR(e.coefficients[0], 1.0, 0.1) << "whole";
}

}  // namespace
}  // namespace knee_robot::tracing
