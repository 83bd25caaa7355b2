#include "knee_robot/recording/filter.h"
#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

TEST(BaseFit, IsTheSameBesideAKnownEffectAsWithoutIt) {
  const mechanism::Robot robot = simulatedRobot();
  const identification::ObservationOptions options;
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  const recording::Recording recording = simulatedRecording(robot, 1, 20.0, "");
  std::vector<identification::Observation> clean = {identification::observe(robot, columns, recording, options)};
  std::vector<identification::Observation> changed = clean;
  const Stack stack = makeStack(clean, options);

  // 60 N at full speed against lengthening and shortening alike, on actuator 2
  Eigen::MatrixXd effect = changed[0].signals.velocity_m_per_s.col(1).cwiseAbs();
  effect *= 60.0 / effect.maxCoeff();
  Eigen::MatrixXd effects = Eigen::MatrixXd::Zero(effect.size(), 4);
  effects.col(1) = effect;
  recording::ZeroPhaseLowPass(options.cutoff_hz, 1.0 / changed[0].signals.period_s).applyToColumns(effect);
  changed[0].force_filtered_N.col(1) += effect;

  BaseOptions beside_effects;
  beside_effects.beside.force_N = {effects};
  const BaseFit without = fitBase(robot, clean, stack, columns);
  const BaseFit beside = fitBase(robot, changed, stack, columns, beside_effects);
  const BaseFit ignoring = fitBase(robot, changed, stack, columns);
  EXPECT_EQ(beside.coordinates(), without.coordinates());
  EXPECT_LT((beside.parameters - without.parameters).norm(), 1e-6 * without.parameters.norm());
  EXPECT_GT((ignoring.parameters - without.parameters).norm(), 1e-2 * without.parameters.norm());
}

}  // namespace
}  // namespace knee_robot::tracing
