// Friction as a function of what has passed since the last reversal.
#include <algorithm>
#include <cmath>

#include "knee_robot/mechanism/decompositions.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class HistoryMap : public SearchedMachine {
 protected:
  const Candidate& map(const std::string& depends_on) {
    maps_ = mapCandidates(data_.inputs);
    return **std::find_if(maps_.begin(), maps_.end(),
                          [&](const auto& c) { return c->dependsOn(kActuator) == depends_on; });
  }
  std::vector<double> knots(const Candidate& c) { return c.shapes(data_.inputs.front(), kActuator).front(); }

  CandidateList maps_;
};

TEST_F(HistoryMap, HasItsKnotsCloserTogetherSoonAfterAReversal) {
  for (const char* history :
       {"time_since_reversal_2_s_times_direction", "distance_since_reversal_2_m_times_direction"}) {
    const std::vector<double> at = knots(map(history));
    ASSERT_EQ(at.size(), 8u);
    EXPECT_LT(at[1] - at[0], 0.5 * (at[7] - at[6])) << history;
    EXPECT_TRUE(std::is_sorted(at.begin(), at.end())) << history;
  }
}

TEST_F(HistoryMap, FollowsFrictionThatFallsOffWithinASecondOfEveryReversal) {
  const EffectInput& input = data_.inputs.front();
  const Candidate& since = map("time_since_reversal_2_s_times_direction");
  const Eigen::MatrixXd columns = since.columns(input, kActuator, knots(since));
  Eigen::VectorXd friction(input.samples());
  for (int n = 0; n < input.samples(); ++n)
    friction[n] = input.share(n, kActuator) * std::exp(-input.since_reversal_s(n, kActuator) / 0.8);
  const Eigen::VectorXd fit = columns.colPivHouseholderQr().solve(friction);
  EXPECT_LT((friction - columns * fit).norm(), 0.1 * friction.norm());
}

}  // namespace
}  // namespace knee_robot::tracing
