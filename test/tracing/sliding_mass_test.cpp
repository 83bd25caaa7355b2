// A mass that slides on the platform, against what is worked out by hand.
#include <algorithm>
#include <cmath>

#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr double kHalf_m = 0.05, kFriction = 0.5;  ///< m/s^2: 2.9 degrees
constexpr double kGravity = 9.81;

class SlidingMass : public testing::Test {
 protected:
  static constexpr double kPeriod_s = 0.01;
  static constexpr int kEach = 400;  ///< samples of every tilt
  SlidingMass() {
    input_.robot = &robot_;
    input_.observation = &observation_;
    observation_.signals.period_s = kPeriod_s;
  }
  /// The platform stands at one angle theta after the other.
  void tilt(const std::vector<double>& theta_rad) {
    const int samples = kEach * static_cast<int>(theta_rad.size());
    observation_.motion.motion.resize(static_cast<std::size_t>(samples));
    observation_.signals.force_N = Eigen::MatrixXd::Zero(samples, robot_.axes());
    observation_.signals.position_m = observation_.signals.velocity_m_per_s = observation_.signals.force_N;
    for (int n = 0; n < samples; ++n) {
      const double theta = theta_rad[static_cast<std::size_t>(n / kEach)];
      observation_.motion.motion[static_cast<std::size_t>(n)].pose << 0.0, 0.7, theta, 0.0;
      observation_.signals.time_s.push_back(kPeriod_s * n);
      input_.rotation.push_back(Eigen::AngleAxisd(theta, mechanism::Vector3::UnitY()).toRotationMatrix());
    }
    input_.force_per_pose_force.assign(static_cast<std::size_t>(samples), mechanism::Matrix4::Identity());
    moment_ = columns(0.0, 0.0);
  }
  /// Moment about theta that holds the platform, per kilogram.
  Eigen::VectorXd columns(double direction_rad, double start) const {
    const auto mass = std::find_if(all_.begin(), all_.end(), [](const auto& c) { return c->name() == "sliding_mass"; });
    return (*mass)->columns(input_, 2, {direction_rad, kHalf_m, kFriction, 1.0, start, 0.0, 0.0}).col(0);
  }
  double atTheEndOf(int tilt) const { return moment_[kEach * (tilt + 1) - 1]; }

  const mechanism::Robot robot_ = identification::syntheticRobot();
  const CandidateList all_ = namedCandidates(robot_);
  identification::Observation observation_;
  EffectInput input_;
  Eigen::VectorXd moment_;
};

TEST_F(SlidingMass, StaysWhereItsFrictionHoldsIt) {
  tilt({0.0, 0.04, -0.04});
  EXPECT_LT(moment_.cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(SlidingMass, SlidesToTheStopThatIsLowerAndStaysThereWhenThePlatformIsLevelAgain) {
  tilt({0.2, 0.0, -0.2, 0.0});
  for (const int lower : {0, 2}) {
    const double side = lower == 0 ? 1.0 : -1.0;  // theta lowers the end at +x: the moment that holds it is negative
    EXPECT_NEAR(atTheEndOf(lower), -side * kHalf_m * kGravity * std::cos(0.2), 1e-6);
    EXPECT_NEAR(atTheEndOf(lower + 1), -side * kHalf_m * kGravity, 1e-6);
  }
}

TEST_F(SlidingMass, TakesTheTimeOfAMassOnAnInclineWithFriction) {
  tilt({0.2});
  const double down = kGravity * std::sin(0.2) - kFriction;
  const double arrives_s = std::sqrt(2.0 * kHalf_m / down);  // without drag, which is a tenth of a second late
  const int early = static_cast<int>(0.8 * arrives_s / kPeriod_s), late = static_cast<int>(1.3 * arrives_s / kPeriod_s);
  EXPECT_GT(moment_[early], 0.9 * moment_[kEach - 1]) << "still on its way";
  EXPECT_NEAR(moment_[late], moment_[kEach - 1], 1e-6) << "there";
}

TEST_F(SlidingMass, AcrossTheTiltDoesNotSlide) {
  tilt({0.2, -0.2});
  EXPECT_LT(columns(M_PI / 2.0, 0.0).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(SlidingMass, BeginsWhereItLayInThatRecording) {
  tilt({0.0, 0.2});
  const Eigen::VectorXd from_one_end = columns(0.0, -1.0);
  EXPECT_NEAR(from_one_end[0], kHalf_m * kGravity, 1e-6);
  EXPECT_NEAR(from_one_end.tail(1)[0], moment_.tail(1)[0], 1e-6) << "where it began is forgotten at a stop";
  input_.recording = -1;
  EXPECT_NEAR(columns(0.0, -1.0)[0], 0.0, 1e-9) << "of other recordings nobody knows";
}

}  // namespace
}  // namespace knee_robot::tracing
