// A mass on the platform that swings along one direction.
#include <algorithm>
#include <cmath>

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class WobblingMass : public testing::Test {
 protected:
  /// The platform in the middle, level, shaken along x: this acceleration from the second sample on.
  static constexpr double kPeriod_s = 0.005;
  static constexpr int kSamples = 2000;
  WobblingMass() {
    input_.robot = &robot_;
    input_.observation = &observation_;
    observation_.signals.period_s = kPeriod_s;
    observation_.motion.motion.resize(kSamples);
    for (int n = 0; n < kSamples; ++n) {
      observation_.signals.time_s.push_back(kPeriod_s * n);
      observation_.motion.motion[static_cast<std::size_t>(n)].pose << 0.0, 0.7, 0.0, 0.0;
    }
    observation_.signals.force_N = Eigen::MatrixXd::Zero(kSamples, robot_.axes());
    observation_.signals.position_m = observation_.signals.velocity_m_per_s = observation_.signals.force_N;
    input_.rotation.assign(kSamples, mechanism::Matrix3::Identity());
    input_.force_per_pose_force.assign(kSamples, mechanism::Matrix4::Identity());  // "actuators" of the pose itself
  }
  void shake(double amplitude_m_per_s2, double frequency_Hz) {
    for (int n = 1; n < kSamples; ++n)
      observation_.motion.motion[static_cast<std::size_t>(n)].pose_acceleration[0] =
          amplitude_m_per_s2 * std::sin(2.0 * M_PI * frequency_Hz * kPeriod_s * n);
  }
  /// Force along a coordinate of the pose, per kilogram.
  Eigen::VectorXd force(int coordinate, const std::vector<double>& shape) const {
    const auto mass =
        std::find_if(all_.begin(), all_.end(), [](const auto& c) { return c->name() == "wobbling_mass"; });
    return (*mass)->columns(input_, coordinate, shape).col(0);
  }
  double amplitude(const Eigen::VectorXd& force) const { return force.tail(kSamples / 4).cwiseAbs().maxCoeff(); }

  const mechanism::Robot robot_ = identification::syntheticRobot();
  const CandidateList all_ = namedCandidates(robot_);
  identification::Observation observation_;
  EffectInput input_;
};

TEST_F(WobblingMass, IsARigidOneWhereItIsShakenSlowly) {
  shake(1.0, 0.2);
  EXPECT_LT(amplitude(force(0, {8.0, 0.3, 0.0, 0.0, 0.0, 0.0, 10.0})), 0.01)
      << "what a rigid mass does is not its part";
}

TEST_F(WobblingMass, StaysBehindWhereItIsShakenFast) {
  shake(1.0, 8.0);
  const double ratio = 8.0 / 0.8;  // of a spring with hardly a damper: 1 / (1 - 1/r^2) times the platform's
  EXPECT_NEAR(amplitude(force(0, {0.8, 0.3, 0.0, 0.0, 0.0, 0.0, 10.0})), 1.0, 2.0 / ratio)
      << "the platform does not carry its mass along";
}

TEST_F(WobblingMass, RocksThePlatformByTheWeightThatItShifts) {
  shake(0.5, 0.2);
  const double softly = 2.0 * M_PI * 2.0;
  const double shifted_m = 0.5 / (softly * softly);
  EXPECT_NEAR(amplitude(force(2, {2.0, 0.5, 0.0, 0.0, 0.0, 0.0, 10.0})), 9.81 * shifted_m, 0.05 * 9.81 * shifted_m);
}

TEST_F(WobblingMass, GivesLessWhereItsSpringStiffens) {
  shake(2.0, 0.2);
  EXPECT_LT(amplitude(force(2, {0.6, 0.5, 0.0, 0.0, 0.0, 0.0, 0.02})),
            0.5 * amplitude(force(2, {0.6, 0.5, 0.0, 0.0, 0.0, 0.0, 10.0})));
}

}  // namespace
}  // namespace knee_robot::tracing
