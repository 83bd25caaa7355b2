// A push is an event; what comes back at the same places is a property of the machine.
#include "src/tracing/came_back.h"

#include <cmath>

#include "src/tracing/stretches.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class CameBack : public SearchedMachine {
 protected:
  static constexpr int kNeighbour = 2;

  Hypothesis pushAt(double from_s, double duration_s) const {
    return {{named("external_force", {}).place.candidate, -1}, {1.0, from_s, duration_s}};
  }
  /// A seal on kActuator that rubs where another actuator passes `center_m`, in N.
  Eigen::VectorXd seal(double center_m, double width_m) const {
    const Stack& stack = data_.stack;
    const Eigen::MatrixXd position = positionsOf(data_.recordings, stack);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(stack.size() * stack.axes);
    for (Eigen::Index n = 0; n < stack.size(); ++n) {
      const Pick& pick = stack.picks[static_cast<std::size_t>(n)];
      const double velocity = data_.recordings[pick.recording].signals.velocity_m_per_s(pick.sample, kActuator);
      const double away = (position(n, kNeighbour) - center_m) / width_m;
      force[kActuator * stack.size() + n] = 30.0 * std::tanh(velocity / 0.002) * std::exp(-0.5 * away * away);
    }
    return force;
  }
  /// When the neighbour of recording 1 is nearest to a place in the middle of the recording, s.
  double passage(double& place_m) const {
    const EffectInput& input = data_.inputs.front();
    const int middle = input.samples() / 2;
    place_m = input.signals().position_m(middle, kNeighbour);
    return input.time(middle);
  }
};

TEST_F(CameBack, WhatDependsOnAnotherActuatorsPlaceDoes) {
  double place_m = 0.0;
  const double at_s = passage(place_m);
  const Hypothesis push = pushAt(at_s - 0.4, 0.8);
  const Recurrence found = recurrenceOf(search_, push, seal(place_m, 0.015));
  EXPECT_GT(found.share, 0.7);
  EXPECT_EQ(found.covered, 1.0);
}

TEST_F(CameBack, APushDoesNot) {
  double place_m = 0.0;
  const Hypothesis push = pushAt(passage(place_m) - 1.0, 2.0);
  const Eigen::VectorXd force = effectRows(data_, push) * Eigen::Vector4d(10.0, -60.0, 3.0, 2.0);
  EXPECT_LT(recurrenceOf(search_, push, force).share, 0.1);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 3.0);
  const Eigen::VectorXd noisy = force + Eigen::VectorXd::NullaryExpr(force.size(), [&] { return noise(random); });
  EXPECT_LT(recurrenceOf(search_, push, noisy).share, 0.1);
}

TEST_F(CameBack, WhatHappensWhereTheRobotIsAtNoOtherTimeMayBelongToThePlace) {
  EXPECT_GT(recurrenceOf(search_, pushAt(10.0, 1.0), seal(0.7, 0.1)).covered, 0.8);
  // The other recording is elsewhere, and this one is over when the push is.
  identification::Observation& second = data_.recordings.back();
  second.signals.position_m.array() += 1.0;
  EXPECT_LT(recurrenceOf(search_, pushAt(0.0, 24.0), seal(0.7, 0.1)).covered, 0.1);
}

TEST_F(CameBack, AForceOnThePlatformGoesIntoSeveralLegsOneInALegDoesNot) {
  double place_m = 0.0;
  const Hypothesis push = pushAt(passage(place_m) - 1.0, 2.0);
  EXPECT_LT(shareOfOneActuator(search_, push, Eigen::Vector4d(0.0, -60.0, 0.0, 0.0)), 0.99);
  EXPECT_LT(shareOfOneActuator(search_, push, Eigen::Vector4d(30.0, 0.0, 0.0, 0.0)), 0.99);
  const int middle = data_.inputs.front().samples() / 2;
  const mechanism::Matrix4& columns = data_.inputs.front().force_per_pose_force[static_cast<std::size_t>(middle)];
  const Eigen::Vector4d along_one = columns.inverse().col(kActuator) * 40.0;
  EXPECT_GT(shareOfOneActuator(search_, pushAt(passage(place_m) - 0.1, 0.2), along_one), 0.999);
}

}  // namespace
}  // namespace knee_robot::tracing
