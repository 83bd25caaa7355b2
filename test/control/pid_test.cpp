#include "knee_robot/control/pid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace knee_robot::control {
namespace {

constexpr PidGains kGains{1000.0, 500.0, 50.0, 50.0};

PidInput at(double reference, double measured, double dt = 0.001) {
  PidInput input;
  input.reference = reference;
  input.measured = measured;
  input.dt = dt;
  return input;
}

Pid fresh(double measured = 0.0) {
  Pid pid;
  pid.setGains(kGains);
  pid.reset(measured);
  return pid;
}

TEST(Pid, StartsWithoutAStepOfForceWhereTheAxisStands) {
  Pid pid = fresh(0.7);
  EXPECT_EQ(pid.update(at(0.7, 0.7), 100.0), 0.0);
}

TEST(Pid, AnswersAConstantErrorWithProportionalAndGrowingIntegralPart) {
  Pid pid = fresh();
  double force = 0.0;
  for (int i = 0; i < 1000; ++i)
    force = pid.update(at(0.01, 0.0), 1e6);
  EXPECT_NEAR(force, 1000.0 * 0.01 + 500.0 * 0.01 * 1.0, 1e-9);
}

TEST(Pid, DampsTheMeasuredVelocityThroughItsFilterAndTheReferencesDirectly) {
  Pid pid = fresh();
  PidInput input = at(0.0, 0.0);
  input.reference_velocity = 0.1;
  EXPECT_NEAR(pid.update(input, 1e6), 50.0 * 0.1, 1e-12);
  double force = 0.0;
  for (int i = 1; i <= 200; ++i)
    force = pid.update(at(1e-4 * i, 1e-4 * i), 1e6);
  EXPECT_NEAR(force, -50.0 * 0.1, 1e-6) << "0.1 m/s after the filter has settled";
}

TEST(Pid, DoesNotWindUpWhileClamped) {
  Pid pid = fresh();
  for (int i = 0; i < 10000; ++i)
    EXPECT_EQ(pid.update(at(1.0, 0.0), 20.0), 20.0);
  EXPECT_LE(pid.integral(), 20.0);
  double force = 20.0;
  int cycles = 0;
  while (force > 0.0 && cycles < 5000) {
    force = pid.update(at(0.0, 0.01), 20.0);
    ++cycles;
  }
  EXPECT_LT(cycles, 3) << "comes off the limit at once";
}

TEST(Pid, LetsWhatIsNoNumberThroughInsteadOfAnsweringZero) {
  Pid pid = fresh();
  EXPECT_TRUE(std::isnan(pid.update(at(std::nan(""), 0.0), 20.0)));
  EXPECT_TRUE(std::isnan(fresh().update(at(0.0, std::nan("")), 20.0)));
}

TEST(Pid, AddsTheFeedforwardWithinTheLimit) {
  PidInput input = at(0.0, 0.0);
  input.feedforward = 15.0;
  EXPECT_EQ(fresh().update(input, 20.0), 15.0);
  EXPECT_EQ(fresh().update(input, 10.0), 10.0);
}

}  // namespace
}  // namespace knee_robot::control
