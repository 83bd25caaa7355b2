#include <gtest/gtest.h>

#include <algorithm>

#include "knee_robot/recording/filter.h"
#include "test/tracing/soft_machine.h"

namespace knee_robot::tracing {
namespace {

/// What the machine's forces lack along its encoders' path with its own parameters, and what the columns say; N, slow.
struct Lacking {
  Eigen::MatrixXd forces_N, said_N;
};

constexpr double kStiff_N_per_m = 1e6;

Lacking lackingOf(const mechanism::Robot& robot, const mechanism::Vector4& compliance) {
  const SoftRecording recording(robot, compliance);
  const EffectInput& in = recording.input;
  Lacking out{recording.lacking_N(), Eigen::MatrixXd::Zero(in.samples(), 4)};
  for (const auto& candidate : namedCandidates(robot)) {
    if (candidate->name() != "flexible_coupling" || !candidate->shared()) continue;
    std::vector<double> shape = {0.0};
    for (int j = 0; j < 4; ++j)
      shape.push_back(1.0 / std::max(compliance[j], 1.0 / kStiff_N_per_m));
    shape.push_back(0.1);
    for (int i = 0; i < 4; ++i)
      out.said_N.col(i) = candidate->columns(in, i, shape);
  }
  const recording::ZeroPhaseLowPass slow(2.0, 1.0 / in.signals().period_s);
  slow.applyToColumns(out.forces_N);
  slow.applyToColumns(out.said_N);
  return out;
}

TEST(FlexibleLegs, ChangeTheForcesByWhatTheColumnsSay) {
  const mechanism::Robot robot = identification::syntheticRobot();
  const Lacking soft = lackingOf(robot, {1e-5, 1e-5, 1e-5, 0.6e-5});
  // Friction's hysteresis between samples, which the stiff machine has as well.
  const Lacking stiff = lackingOf(robot, mechanism::Vector4::Zero());
  for (int i = 0; i < 4; ++i) {
    const auto rows = [&](const Eigen::MatrixXd& all) -> Eigen::VectorXd { return all.col(i).segment(300, 3400); };
    const Eigen::VectorXd given = rows(soft.forces_N) - rows(stiff.forces_N), said = rows(soft.said_N);
    EXPECT_LT((given - said).norm(), 0.3 * given.norm()) << "actuator " << i + 1;
    EXPECT_NEAR(given.dot(said) / said.squaredNorm(), 1.0, 0.15) << "actuator " << i + 1;
  }
}

// 50 kN/m under some 100 N: two millimetres, of which gravity's parameters take up most along these paths.
TEST(FlexibleLegs, AreNamedByTheLoadThatTheyBringToOneAnother) {
  const mechanism::Robot robot = identification::syntheticRobot();
  constexpr double kSoft = 2e-5, kLessSoft = 1.2e-5;  // m/N
  const TraceResult result = tracedSoft(robot, {kSoft, kSoft, kSoft, kLessSoft});
  std::cout << "before " << result.before_rms_N.transpose() << " after " << result.after_rms_N.transpose() << " N\n";
  for (const FoundEffect& found : result.effects)
    std::cout << found.hypothesis.place.candidate->name() << " on " << found.hypothesis.place.actuator << ": "
              << found.coefficients.transpose() << "\n";
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& e = result.effects[0];
  EXPECT_EQ(e.hypothesis.place.candidate->name(), "flexible_coupling");
  EXPECT_EQ(e.hypothesis.place.actuator, -1);
  for (std::size_t j = 1; j <= 3; ++j)
    EXPECT_NEAR(e.coefficients[0] / e.hypothesis.shape[j], kSoft, 0.6 * kSoft) << "leg " << j;
  EXPECT_NEAR(e.coefficients[0] / e.hypothesis.shape[4], kLessSoft, 0.6 * kLessSoft);
}

TEST(FlexibleLegs, AreNotFoundWhereLegsAreStiff) {
  const TraceResult result = tracedSoft(identification::syntheticRobot(), mechanism::Vector4::Zero());
  EXPECT_TRUE(result.effects.empty());
}

}  // namespace
}  // namespace knee_robot::tracing
