// Force as a function of two actuators' velocities: what runs along two legs.
#include <algorithm>
#include <cmath>

#include "knee_robot/mechanism/decompositions.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class PairMap : public SearchedMachine {
 protected:
  const Candidate* map(const std::string& depends_on, int actuator) {
    maps_ = mapCandidates(data_.inputs);
    const auto found =
        std::find_if(maps_.begin(), maps_.end(), [&](const auto& c) { return c->dependsOn(actuator) == depends_on; });
    return found == maps_.end() ? nullptr : found->get();
  }
  double left(const Candidate& c, const Eigen::VectorXd& force) {
    const EffectInput& input = data_.inputs.front();
    const Eigen::MatrixXd columns = c.columns(input, kActuator, c.shapes(input, kActuator).front());
    return (force - columns * Eigen::VectorXd(columns.colPivHouseholderQr().solve(force))).norm() / force.norm();
  }

  CandidateList maps_;
};

TEST_F(PairMap, IsNamedAfterBothActuatorsFromWhicheverItIsSeen) {
  EXPECT_NE(map("velocity_2_plus_velocity_4_m_per_s", 1), nullptr);
  EXPECT_NE(map("velocity_4_plus_velocity_2_m_per_s", 3), nullptr);
  EXPECT_NE(map("velocity_4_minus_velocity_1_m_per_s", 3), nullptr);
  EXPECT_EQ(map("velocity_2_plus_velocity_2_m_per_s", 1), nullptr);
}

TEST_F(PairMap, FollowsARopeThatRubsByTheSumOfTwoVelocitiesAndNoOtherPairDoes) {
  const Eigen::MatrixXd& velocity = data_.inputs.front().signals().velocity_m_per_s;
  const Eigen::VectorXd rope = ((velocity.col(1) + velocity.col(3)).array() / 0.0015).tanh();
  EXPECT_LT(left(*map("velocity_2_plus_velocity_4_m_per_s", kActuator), rope), 0.1);
  EXPECT_GT(left(*map("velocity_2_plus_velocity_1_m_per_s", kActuator), rope), 0.3);
  EXPECT_GT(left(*map("velocity_2_minus_velocity_4_m_per_s", kActuator), rope), 0.3);
}

TEST_F(PairMap, ComesBackFromAModelByItsName) {
  const Candidate& pair = *map("velocity_2_minus_velocity_3_m_per_s", kActuator);
  const std::vector<double> knots = pair.shapes(data_.inputs.front(), kActuator).front();
  EXPECT_TRUE(std::is_sorted(knots.begin(), knots.end()));
  const auto again = mapCandidate(*data_.inputs.front().robot, pair.dependsOn(kActuator), kActuator, knots);
  ASSERT_NE(again, nullptr);
  EXPECT_EQ(again->columns(data_.inputs.front(), kActuator, knots),
            pair.columns(data_.inputs.front(), kActuator, knots));
}

}  // namespace
}  // namespace knee_robot::tracing
