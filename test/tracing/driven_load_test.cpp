// The motion of a screw behind a joint with play, against ways and forces worked out by hand.
#include "src/tracing/effects/common/driven_load.h"

#include <gtest/gtest.h>

#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kDry_N = 10.0, kGap_m = 4e-4, kStep_m = 2e-5;
constexpr int kStroke = 150;  ///< samples: 3 mm

/// A motor that goes 3 mm forth and back at 2 mm/s; nothing moves but by friction.
class DrivenLoad : public testing::Test {
 protected:
  explicit DrivenLoad(const dynamics::FrictionLaw& law = dynamics::stopLaw(1e-6)) {
    recording::Signals& s = observation_.signals;
    s.period_s = 0.01;
    s.motion_cutoff_hz = 20.0;
    const int count = 4 * kStroke;
    input_.observation = &observation_;
    input_.laws = {law};
    input_.friction_position_m = s.velocity_m_per_s = Eigen::MatrixXd::Zero(count, 1);
    s.acceleration_m_per_s2 = s.force_N = s.position_m = input_.load_N = input_.share = s.velocity_m_per_s;
    dynamics::FrictionState friction;
    friction.start(1.0);
    for (int n = 0; n < count; ++n) {
      s.time_s.push_back(s.period_s * n);
      const double step_m = n == 0 ? 0.0 : (n / kStroke) % 2 == 0 ? kStep_m : -kStep_m;
      input_.friction_position_m(n, 0) = (n > 0 ? input_.friction_position_m(n - 1, 0) : 0.0) + step_m;
      s.velocity_m_per_s(n, 0) = step_m / s.period_s;
      input_.share(n, 0) = friction.step(law, step_m, s.period_s);
    }
    input_.coulomb_N = Eigen::VectorXd::Constant(1, kDry_N);
    input_.viscous = input_.rotor_kg = input_.moved_kg = Eigen::VectorXd::Zero(1);
  }
  /// Friction that the motor has to overcome `way_m` behind the second reversal, from where it goes forth again.
  double frictionBehind(double way_m, const DriveJoint& joint) const {
    const Eigen::VectorXd change = changeByJoint(input_, 0, joint);
    const int n = 2 * kStroke + static_cast<int>(std::lround(way_m / kStep_m)) - 1;
    return kDry_N * input_.share(n, 0) + change[n];
  }

  identification::Observation observation_;
  EffectInput input_;
};

DriveJoint playOf(double gap_m, double friction_beyond) {
  DriveJoint joint;
  joint.half_gap_m = 0.5 * gap_m;
  joint.friction_beyond = friction_beyond;
  return joint;
}

TEST_F(DrivenLoad, ARigidJointChangesNothing) {
  for (const double way_m : {1e-4, 3e-4, 1e-3})
    EXPECT_NEAR(frictionBehind(way_m, playOf(0.0, 1.0)), kDry_N, 0.01) << way_m;
}

TEST_F(DrivenLoad, TheMotorCrossesThePlayAlone) {
  EXPECT_NEAR(frictionBehind(0.5 * kGap_m, playOf(kGap_m, 1.0)), 0.0, 0.01);
  EXPECT_NEAR(frictionBehind(1.2 * kGap_m, playOf(kGap_m, 1.0)), kDry_N, 0.01) << "then it takes the screw along";
}

TEST_F(DrivenLoad, FrictionOfTheMotorStaysWithIt) {
  EXPECT_NEAR(frictionBehind(0.5 * kGap_m, playOf(kGap_m, 0.7)), 0.3 * kDry_N, 0.01);
  EXPECT_NEAR(frictionBehind(1.2 * kGap_m, playOf(kGap_m, 0.7)), kDry_N, 0.01);
}

TEST_F(DrivenLoad, ALoadHoldsTheScrewAtOneSideOfThePlay) {
  input_.load_N.setConstant(3.0 * kDry_N);  // more than friction: it never lets go
  for (const double way_m : {1e-4, 3e-4, 1e-3})
    EXPECT_NEAR(frictionBehind(way_m, playOf(kGap_m, 1.0)), kDry_N, 0.02) << way_m;
}

class DrivenLoadOnALongStop : public DrivenLoad {
 protected:
  DrivenLoadOnALongStop() : DrivenLoad(dynamics::stopLaw(5e-4)) {}
};

TEST_F(DrivenLoadOnALongStop, TheScrewsFrictionBuildsUpOverItsOwnWay) {
  const DriveJoint rigid = playOf(0.0, 1.0), play = playOf(kGap_m, 1.0);
  EXPECT_NEAR(frictionBehind(7e-4, rigid), 4.0, 0.05) << "from -10 to 10 N over 1 mm";
  EXPECT_NEAR(frictionBehind(2e-4, play), -6.0, 0.05) << "what the stop holds lets the screw follow the motor";
  EXPECT_NEAR(frictionBehind(7e-4, play), 0.0, 0.05) << "once it holds nothing the play is crossed, to 0.9 mm";
  EXPECT_NEAR(frictionBehind(1.2e-3, play), 6.0, 0.05) << "then friction builds up again";
  EXPECT_NEAR(frictionBehind(2.5e-3, play), kDry_N, 0.05);
}

}  // namespace
}  // namespace knee_robot::tracing
