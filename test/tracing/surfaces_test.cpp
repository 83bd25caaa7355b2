// Dry friction over speed and position, or speed and load, together.
#include "src/tracing/surfaces.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/dynamics/effect_law.h"
#include "knee_robot/mechanism/decompositions.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr const char* kOverPosition = "speed_2_m_per_s_and_position_2_m_times_direction";
constexpr const char* kOverLoad = "speed_2_m_per_s_and_load_2_N_times_direction";

class Surfaces : public SearchedMachine {
 protected:
  const Candidate& surfaceOver(const std::string& depends_on) {
    addSurfaces(data_.inputs, surfaces_);
    return find(surfaces_, depends_on);
  }
  const Candidate& map(const std::string& depends_on) {
    maps_ = mapCandidates(data_.inputs);
    return find(maps_, depends_on);
  }
  static const Candidate& find(const CandidateList& list, const std::string& depends_on) {
    return **std::find_if(list.begin(), list.end(),
                          [&](const auto& c) { return c->dependsOn(kActuator) == depends_on; });
  }
  const EffectInput& input() const { return data_.inputs.front(); }
  Eigen::MatrixXd columns(const Candidate& c) const {
    return c.columns(input(), kActuator, c.shapes(input(), kActuator).front());
  }
  double left(const Candidate& c, const Eigen::VectorXd& force) const {
    const Eigen::MatrixXd all = columns(c);
    return (force - all * Eigen::VectorXd(all.completeOrthogonalDecomposition().solve(force))).norm() / force.norm();
  }
  /// A screw that whirls: friction about a speed that falls as the actuator gets longer.
  Eigen::VectorXd whirl() const {
    const Eigen::ArrayXd speed = input().signals().velocity_m_per_s.col(kActuator).array().abs();
    const Eigen::ArrayXd length = input().signals().position_m.col(kActuator);
    const double fastest = speed.maxCoeff();
    const Eigen::ArrayXd at =
        fastest * (0.9 - 0.7 * (length - length.minCoeff()) / (length.maxCoeff() - length.minCoeff()));
    const Eigen::ArrayXd hump = (-((speed - at) / (0.25 * fastest)).square()).exp();
    return hump * input().share.col(kActuator).array();
  }

  CandidateList surfaces_, maps_;
};

TEST_F(Surfaces, FollowAWhirlingScrewWhichMapsOverSpeedOrPositionDoNot) {
  EXPECT_LT(left(surfaceOver(kOverPosition), whirl()), 0.3);
  EXPECT_GT(left(map("velocity_2_m_per_s"), whirl()), 0.5);
  EXPECT_GT(left(map("position_2_m_times_direction"), whirl()), 0.5);
}

TEST_F(Surfaces, FollowFrictionThatALoadMakesSlippery) {
  const Eigen::ArrayXd speed = input().signals().velocity_m_per_s.col(kActuator).array().abs();
  const Eigen::ArrayXd load = input().load_N.col(kActuator).array().abs();
  const Eigen::VectorXd force = load * (-speed / (0.3 * speed.maxCoeff())).exp() * input().share.col(kActuator).array();
  EXPECT_LT(left(surfaceOver(kOverLoad), force), 0.25);
}

TEST_F(Surfaces, ComeBackFromAModelByTheirNamesAndKnots) {
  for (const char* name : {kOverPosition, kOverLoad}) {
    const Candidate& found = surfaceOver(name);
    const std::vector<double> knots = found.shapes(input(), kActuator).front();
    EXPECT_EQ(found.coefficients(input()).size(), static_cast<std::size_t>(columns(found).cols()));
    EXPECT_EQ(found.shapeParameters().size(), knots.size());
    const auto again = mapCandidate(robot_, name, kActuator, knots);
    ASSERT_NE(again, nullptr);
    EXPECT_EQ(again->columns(input(), kActuator, knots), columns(found));
    EXPECT_EQ(mapCandidate(robot_, name, kActuator, {knots.begin(), knots.end() - 1}), nullptr);
    EXPECT_EQ(mapCandidate(robot_, name, kActuator + 1, knots), nullptr) << "it is another actuator's";
    EXPECT_EQ(dynamics::effectLaw("unnamed", name, knots), nullptr) << "too many coefficients for the controller";
  }
}

}  // namespace
}  // namespace knee_robot::tracing
