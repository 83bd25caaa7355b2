// Another patient, another mass: the platform carries more in one recording than in the other.
#include <algorithm>

#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

constexpr double kCarried_kg = 3.0, kForward_m = 0.08;

/// Traced on an empty platform and on one that carries something, along these variants of the reference.
TraceResult traceCarrying(int empty, int laden) {
  constexpr double kSeconds = 30.0;
  const mechanism::Robot robot = simulatedRobot();
  TraceOptions options;
  options.surrogates = 5;
  const std::vector<recording::Recording> both = {
      simulatedRecording(robot, empty, kSeconds, ""),
      simulatedRecording(robot, laden, kSeconds, "  - {name: payload, mass_kg: 3, center_m: [0.08, 0, 0]}\n")};
  return trace(robot, both,
               identification::observeAll(robot, identification::columnsOf(robot), both, options.observation), options);
}

void expectNamed(const TraceResult& result) {
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& found = result.effects[0];
  EXPECT_EQ(found.hypothesis.place.candidate->name(), "payload_change");
  std::cout << "first moments and mass: " << found.coefficients.transpose() << "\n";
  ASSERT_EQ(found.coefficients.size(), 4);
  EXPECT_NEAR(found.coefficients[0], kCarried_kg * kForward_m, 0.03);
  EXPECT_NEAR(found.coefficients[3], kCarried_kg, 0.1);
  EXPECT_EQ(found.hypothesis.place.candidate->elsewhere(found.coefficients).size(), 0)
      << "what the next recording carries is not known: the baseline has the mean";
}

TEST(PayloadChange, IsNamedBetweenTwoMovements) {
  expectNamed(traceCarrying(1, 2));
}

TEST(PayloadChange, IsNoNoiseBetweenRepeatsOfOneReference) {
  const TraceResult result = traceCarrying(1, 1);
  expectNamed(result);
  EXPECT_LT(result.floor_N.maxCoeff(), 3.0) << result.floor_source;
}

}  // namespace
}  // namespace knee_robot::tracing
