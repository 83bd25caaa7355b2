// A map that explains what was held back better than a name does makes the name doubtful.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "test/tracing/traced_bench.h"

namespace knee_robot::tracing {
namespace {

/// Drag that builds up along every stroke, as of balls that crowd: no effect has that name, a spring that relaxes and
/// presliding look like it.
recording::Recording crowdedBench() {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.3);
  recording::Recording r = identification::syntheticRecording(bench(), identification::syntheticModel(bench()), 0, 60.0,
                                                              [&] { return noise(random); });
  constexpr double kDrag_N = 12.0, kLength_m = 0.014, kBack_m = 3e-5;
  double turned_m = r.position_m(0, 0), furthest_m = turned_m, direction = 1.0;
  for (Eigen::Index n = 0; n < r.position_m.rows(); ++n) {
    const double here_m = r.position_m(n, 0);
    if (direction * (here_m - furthest_m) > 0.0) furthest_m = here_m;
    if (direction * (furthest_m - here_m) > kBack_m) {
      turned_m = furthest_m;
      furthest_m = here_m;
      direction = -direction;
    }
    r.force_N(n, 0) += direction * kDrag_N * (1.0 - std::exp(-std::abs(here_m - turned_m) / kLength_m));
  }
  return r;
}

TEST(MapRival, TakesTheNameFromWhatItExplainsBetter) {
  const TracedBench traced = tracedBench(crowdedBench(), nullptr);
  ASSERT_FALSE(traced.result.effects.empty());
  for (const FoundEffect& e : traced.result.effects) {
    const Candidate& c = *e.hypothesis.place.candidate;
    std::cout << c.name() << " on " << e.hypothesis.place.actuator + 1 << ", probability " << e.probability
              << (e.doubted ? ", doubted" : "") << (c.isMap() ? " " + c.dependsOn(0) : "") << "\n";
    EXPECT_TRUE(c.isMap() || e.doubted) << c.name();
  }
}

}  // namespace
}  // namespace knee_robot::tracing
