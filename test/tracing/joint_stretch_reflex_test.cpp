// A patient's muscles about a joint: they resist, late, when they are stretched fast.
#include <cmath>
#include <random>

#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/tracing/trace.h"
#include "test/identification/synthetic.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr double kDelayed_s = 0.06, kLetsGo_s = 0.15, kStretched_rad = 0.05, kFrom_rad_per_s = 0.1, kCatch_Nm = 15.0;

class JointReflex : public SearchedMachine {
 protected:
  Eigen::MatrixXd columns(int coordinate, double threshold) const {
    const Hypothesis h = named("joint_stretch_reflex",
                               {static_cast<double>(coordinate), threshold, kDelayed_s, kLetsGo_s, kStretched_rad});
    return h.place.candidate->columns(data_.inputs.front(), kActuator, h.shape);
  }
  Eigen::VectorXd rate(int coordinate) const {
    const auto& motion = data_.inputs.front().observation->motion.motion;
    Eigen::VectorXd out(static_cast<Eigen::Index>(motion.size()));
    for (Eigen::Index n = 0; n < out.size(); ++n)
      out[n] = motion[static_cast<std::size_t>(n)].pose_velocity[coordinate];
    return out;
  }
};

TEST_F(JointReflex, IsCalledByFastTurningAloneEitherWayForItself) {
  for (const int coordinate : {2, 3}) {
    const double rising = rate(coordinate).maxCoeff(), falling = -rate(coordinate).minCoeff();
    EXPECT_TRUE(columns(coordinate, 1.01 * std::max(rising, falling)).isZero(1e-12)) << "slow turning calls none";
    const Eigen::MatrixXd both = columns(coordinate, 0.5 * std::min(rising, falling));
    EXPECT_GT(both.col(0).norm(), 1.0);
    EXPECT_GT(both.col(1).norm(), 1.0);
    Eigen::Index fast = 0, called = 0;
    while (rate(coordinate)[fast] <= 0.5 * std::min(rising, falling))
      ++fast;
    while (both(called, 0) == 0.0)
      ++called;
    EXPECT_NEAR(static_cast<double>(called - fast) * data_.inputs.front().signals().period_s, kDelayed_s, 0.03);
  }
}

TEST_F(JointReflex, ResistsTheTurning) {
  const EffectInput& in = data_.inputs.front();
  const Eigen::VectorXd turning = rate(2);
  const Eigen::MatrixXd both = columns(2, 0.5 * turning.cwiseAbs().maxCoeff());
  for (int n = 0; n < in.samples(); ++n) {
    const double lever = in.force_per_pose_force[static_cast<std::size_t>(n)](kActuator, 2);
    EXPECT_GE(both(n, 0) * lever, 0.0) << "a positive moment is needed while theta rises";
    EXPECT_LE(both(n, 1) * lever, 0.0);
  }
}

constexpr double kLong_s = 40.0;

/// Somebody whose muscles answer the rising theta, simulated in small steps.
recording::Recording spasticRecording(const mechanism::Robot& robot, int variant) {
  std::mt19937 random(static_cast<unsigned>(variant) + 1u);
  std::normal_distribution<double> noise(0.0, 0.3);
  recording::Recording r = identification::syntheticRecording(robot, identification::syntheticModel(robot), variant,
                                                              kLong_s, [&] { return noise(random); });
  const std::vector<identification::Sines> sines = identification::syntheticMotion(false, variant);
  constexpr double kStep_s = 0.001;
  double activation = 0.0, time_s = 0.0;
  for (Eigen::Index k = 0; k < r.force_N.rows(); ++k) {
    const double middle_s = 0.01 * static_cast<double>(k) + 0.005;
    for (; time_s < middle_s; time_s += kStep_s) {
      const double seen_s = std::max(0.0, time_s - kDelayed_s);
      const double stretching = identification::syntheticState(robot, sines, seen_s, kLong_s).motion.pose_velocity[2];
      activation += kStep_s * ((1.0 - activation) * std::max(0.0, stretching - kFrom_rad_per_s) / kStretched_rad -
                               activation / kLetsGo_s);
    }
    const mechanism::Pose pose = identification::syntheticState(robot, sines, middle_s, kLong_s).motion.pose;
    const mechanism::Vector4 on_pose(0.0, 0.0, kCatch_Nm * activation, 0.0);
    r.force_N.row(k) += mechanism::lengthJacobian(*robot.mechanism, pose).transpose().inverse() * on_pose;
  }
  return r;
}

TEST(Trace, NamesTheReflexOfAPatientsJoint) {
  const mechanism::Robot robot = identification::syntheticRobot();
  const std::vector<recording::Recording> recordings = {spasticRecording(robot, 0), spasticRecording(robot, 1)};
  TraceOptions options;
  options.surrogates = 5;
  const TraceResult result = trace(
      robot, recordings,
      identification::observeAll(robot, identification::columnsOf(robot), recordings, options.observation), options);
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& e = result.effects[0];
  EXPECT_EQ(e.hypothesis.place.candidate->name(), "joint_stretch_reflex");
  std::cout << "threshold " << e.hypothesis.shape[1] << " rad/s, delay " << e.hypothesis.shape[2] << " s, lets go in "
            << e.hypothesis.shape[3] << " s; moments " << e.coefficients.transpose() << " N m\n";
  EXPECT_EQ(e.hypothesis.shape[0], 2.0) << "theta";
  EXPECT_NEAR(e.hypothesis.shape[1], kFrom_rad_per_s, 0.05);
  EXPECT_NEAR(e.hypothesis.shape[2], kDelayed_s, 0.025);
  EXPECT_GT(e.coefficients[0], 5.0 * e.coefficients[1]) << "it answers one way";
  EXPECT_TRUE(e.transfers);
}

}  // namespace
}  // namespace knee_robot::tracing
