// The laws by themselves: passivity of the error dynamics along closed loops with Simbody as the robot, and what is
// refused.
#include "knee_robot/control/control_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "knee_robot/simulation/simbody_robot.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::control {
namespace {

using mechanism::Vector4;

constexpr double kP = 60000.0, kI = 300000.0, kD = 1500.0, kLambda = 20.0;  // as in config/deployment

/// Robot A as Simbody builds it, under the passivity-based law in continuous time with a model whose parameters are
/// `scale` times its own. Integrated with the storage's balance, whose terms are calculated from Simbody's motion.
class ClosedLoop {
 public:
  explicit ClosedLoop(double scale)
      : robot_(mechanism::configuredRobot("A")),
        inertia_(dynamics::loadRobotInertia(robot_)),
        truth_(robot_, inertia_),
        model_(robot_, inertia_),
        peer_(*robot_.mechanism, robot_.gravity, inertia_) {
    model_.parameters *= scale;
    Vector4 home;
    for (int i = 0; i < 4; ++i)
      home[i] = robot_.actuators[static_cast<std::size_t>(i)].home_length_m;
    home_ = home;
    state_.pose = mechanism::forwardKinematicsFromHome(*robot_.mechanism, home).pose;
    state_.pose += mechanism::Pose(0.002, -0.001, 0.01, -0.01);  // begins away from its reference
  }
  struct State {
    mechanism::Pose pose = mechanism::Pose::Zero();
    Vector4 velocity = Vector4::Zero(), integral = Vector4::Zero();
    double balance = 0.0;  // integral of what the proof says that the storage changes by
    State plus(const State& rate, double dt) const {
      return {pose + dt * rate.pose, velocity + dt * rate.velocity, integral + dt * rate.integral,
              balance + dt * rate.balance};
    }
  };
  /// Everything at one instant.
  struct Error {
    Vector4 e, rate, s, length_velocity, reference_velocity, reference_acceleration;
  };
  Error errorOf(const State& at, double t) const {
    const Vector4 phase(0.0, 1.0, 2.0, 3.0), size(0.01, 0.012, 0.008, 0.01);
    Vector4 wanted, velocity, acceleration;
    for (int i = 0; i < 4; ++i) {
      const double x = 2.0 * t + phase[i];
      wanted[i] = home_[i] + size[i] * (std::sin(x) - std::sin(phase[i]));
      velocity[i] = 2.0 * size[i] * std::cos(x);
      acceleration[i] = -4.0 * size[i] * std::sin(x);
    }
    Error out;
    out.length_velocity = mechanism::lengthJacobian(*robot_.mechanism, at.pose) * at.velocity;
    out.e = wanted - mechanism::legLengths(*robot_.mechanism, at.pose);
    out.rate = velocity - out.length_velocity;
    out.s = out.rate + kLambda * out.e;
    out.reference_velocity = velocity + kLambda * out.e;
    out.reference_acceleration = acceleration + kLambda * out.rate;
    return out;
  }
  Vector4 auxiliary(const dynamics::PartedModel& model, const State& at, const Error& error) {
    Vector4 force = Vector4::Zero();
    EXPECT_TRUE(dynamics::auxiliaryForces(
        model, at.pose, {error.length_velocity, error.reference_velocity, error.reference_acceleration}, data_, force));
    return force;
  }
  Vector4 weight(const dynamics::PartedModel& model, const State& at) {
    dynamics::ForceParts parts;
    EXPECT_TRUE(dynamics::forceParts(model, at.pose, Vector4::Zero(), Vector4::Zero(), 1e-3, parts_data_, parts));
    return parts.gravity;
  }
  State rateOf(const State& at, double t) {
    const Error error = errorOf(at, t);
    const Vector4 predicted = auxiliary(model_, at, error) + weight(model_, at);
    const Vector4 force = predicted + kP * error.e + kD * error.rate + kI * at.integral;
    peer_.set(mechanism::coordinateMotion(*robot_.mechanism, {at.pose, at.velocity, Vector4::Zero()}));
    const Vector4 acceleration = peer_.actuatorAccelerations(force);
    State rate;
    rate.pose = at.velocity;
    Vector4 same;
    EXPECT_TRUE(
        mechanism::poseRates(*robot_.mechanism, at.pose, error.length_velocity, acceleration, same, rate.velocity));
    rate.integral = error.e;
    const Vector4 disturbance = auxiliary(truth_, at, error) + weight(truth_, at) - predicted;
    const double k = kP - kD * kLambda;
    rate.balance = error.s.dot(disturbance) - kD * error.s.squaredNorm() - (k * kLambda - kI) * error.e.squaredNorm();
    return rate;
  }
  void step(double dt) {
    const State a = rateOf(state_, t_), b = rateOf(state_.plus(a, dt / 2), t_ + dt / 2);
    const State c = rateOf(state_.plus(b, dt / 2), t_ + dt / 2), d = rateOf(state_.plus(c, dt), t_ + dt);
    state_ = state_.plus(a, dt / 6).plus(b, dt / 3).plus(c, dt / 3).plus(d, dt / 6);
    t_ += dt;
  }
  /// Its kinetic part is Simbody's kinetic energy of a motion with the velocities s.
  double storage() {
    const Error error = errorOf(state_, t_);
    mechanism::Motion as_if{state_.pose, Vector4::Zero(), Vector4::Zero()};
    EXPECT_TRUE(mechanism::poseRates(*robot_.mechanism, state_.pose, error.s, Vector4::Zero(), as_if.pose_velocity,
                                     as_if.pose_acceleration));
    peer_.set(mechanism::coordinateMotion(*robot_.mechanism, as_if));
    const double k = kP - kD * kLambda;
    return peer_.kineticEnergy() + 0.5 * k * error.e.squaredNorm() + kI * error.e.dot(state_.integral) +
           0.5 * kLambda * kI * state_.integral.squaredNorm();
  }
  double balance() const { return state_.balance; }
  double largestError() const { return errorOf(state_, t_).e.cwiseAbs().maxCoeff(); }

 private:
  mechanism::Robot robot_;
  dynamics::RobotInertia inertia_;
  dynamics::PartedModel truth_, model_;
  simulation::SimbodyRobot peer_;
  dynamics::AuxiliaryData data_;
  dynamics::ForcePartsData parts_data_;
  Vector4 home_ = Vector4::Zero();
  State state_;
  double t_ = 0.0;
};

TEST(PassivityBasedLaw, LetsTheStorageOfSimbodysRobotOnlyFallWithAnExactModel) {
  ClosedLoop loop(1.0);
  const double first = loop.storage();
  double last = first;
  for (int k = 0; k < 400; ++k) {
    loop.step(5e-4);
    if (k % 10 != 9) continue;
    const double now = loop.storage();
    EXPECT_LT(now, last + 1e-9 * first);
    EXPECT_NEAR(now - first, loop.balance(), 1e-4 * first) << "the rate of the proof, integrated";
    last = now;
  }
  std::printf("storage: %.3e J at the start, %.3e J after 0.2 s\n", first, last);
  EXPECT_LT(last, 0.02 * first);
}

TEST(PassivityBasedLaw, KeepsTheBalanceOfStorageWithAWrongModelToo) {
  for (const double scale : {0.5, 1.6}) {
    ClosedLoop loop(scale);
    const double first = loop.storage();
    for (int k = 0; k < 400; ++k)
      loop.step(5e-4);
    EXPECT_NEAR(loop.storage() - first, loop.balance(), 1e-4 * first) << scale;
    EXPECT_LT(loop.storage(), first) << scale;
    EXPECT_LT(loop.largestError(), 1e-3) << scale;
  }
}

TEST(PassivityBasedLaw, IsPassiveBetweenTwoValuesOfLambdaAndSaysWhich) {
  EXPECT_EQ(ControlLaw::whyNotPassive(20.0, kP, kI, kD), "");
  EXPECT_NE(ControlLaw::whyNotPassive(50.0, kP, kI, kD).find("between 5.85786 and 34.1421"), std::string::npos)
      << ControlLaw::whyNotPassive(50.0, kP, kI, kD);
  EXPECT_NE(ControlLaw::whyNotPassive(3.0, kP, kI, kD), "");
  EXPECT_NE(ControlLaw::whyNotPassive(20.0, kP, 1e6, kD).find("P^2 > 4 D I"), std::string::npos);
  EXPECT_NE(ControlLaw::whyNotPassive(20.0, kP, kI, 0.0), "");
}

TEST(ComputedTorque, PassesTheErrorThroughTheMassOfAllAxesTogether) {
  const mechanism::Robot robot = mechanism::configuredRobot("A");
  const dynamics::PartedModel model(robot, dynamics::loadRobotInertia(robot));
  ControlLaw law;
  law.choose(Law::ComputedTorque);
  ControlLaw::Instant at;
  for (int i = 0; i < 4; ++i)
    at.position[i] = robot.actuators[static_cast<std::size_t>(i)].home_length_m;
  at.pose = mechanism::forwardKinematicsFromHome(*robot.mechanism, at.position).pose;
  at.dt = 0.001;
  law.reset(at.position);
  const Vector4 error(1e-3, -2e-3, 0.0, 5e-4);
  at.reference = at.position + error;
  Vector4 force, mass_times;
  ASSERT_TRUE(law.force(model, {4000.0, 125.0, 20.0, 100.0}, at, force));
  dynamics::AuxiliaryData data;
  ASSERT_TRUE(
      dynamics::auxiliaryForces(model, at.pose, {Vector4::Zero(), Vector4::Zero(), 4000.0 * error}, data, mass_times));
  EXPECT_LT((force - mass_times).norm(), 1e-9 * mass_times.norm());
  EXPECT_GT(std::abs(force[2]), 1e-3) << "leg 3 is without error, but the legs are coupled";
  law.choose(Law::Feedforward);
  ASSERT_TRUE(law.force(model, {4000.0, 125.0, 20.0, 100.0}, at, force));
  EXPECT_EQ(force.norm(), 0.0) << "the Drivers' own loops are all there is";
}

TEST(Laws, AreNamedAsInTheDeploymentFile) {
  EXPECT_EQ(lawNamed("feedforward"), Law::Feedforward);
  EXPECT_EQ(lawNamed("computed_torque"), Law::ComputedTorque);
  EXPECT_EQ(lawNamed("passivity_based"), Law::PassivityBased);
  EXPECT_FALSE(lawNamed("pid").has_value());
}

}  // namespace
}  // namespace knee_robot::control
