// What carries an axis, learned from what its drive gives at rest and in motion.
#include "src/control/carried_load.h"

#include <gtest/gtest.h>

#include <cmath>

namespace knee_robot::control {
namespace {

constexpr double kDt = 0.001;
constexpr double kWeight_N = 200.0, kBeside_N = 40.0, kFriction_N = 25.0;

/// An axis whose weight the model knows, with a load and friction that it does not.
struct LoadedAxis {
  AxisCommand command;
  CarriedLoad load;

  LoadedAxis() {
    command.weight_N = kWeight_N;
    load.begin(command);
  }
  void stand(double seconds, double friction_N) {
    command.at_rest = true;
    command.reference_velocity = 0.0;
    for (double t = 0.0; t < seconds; t += kDt)
      load.learn(command, command.weight_N + kBeside_N + friction_N, 0.0, kDt);
  }
  void swing(double seconds, double period_s) {
    command.at_rest = false;
    for (double t = 0.0; t < seconds; t += kDt) {
      command.reference_velocity = 0.05 * std::sin(2.0 * M_PI * t / period_s);
      const double friction_N = std::copysign(kFriction_N, command.reference_velocity);
      load.learn(command, command.weight_N + kBeside_N + friction_N, 0.0, kDt);
    }
  }
};

TEST(CarriedLoad, AtRestIsWhatTheDriveGivesWhateverPartOfItIsFriction) {
  LoadedAxis axis;
  axis.stand(3.0, 0.9 * kFriction_N);
  EXPECT_NEAR(axis.load.atRest_N(), kWeight_N + kBeside_N + 0.9 * kFriction_N, 0.5);
}

TEST(CarriedLoad, InMotionThatTurnsIsWithoutFriction) {
  for (const double standing_N : {-0.9 * kFriction_N, 0.0, 0.9 * kFriction_N}) {
    LoadedAxis axis;
    axis.stand(3.0, standing_N);
    axis.swing(3.0, 2.0);
    EXPECT_NEAR(axis.load.atRest_N(), kWeight_N + kBeside_N, 0.2 * kFriction_N) << standing_N;
  }
}

/// So that an axis that goes on by itself is braked by friction.
TEST(CarriedLoad, InTheFirstStrokeIsLessThanWhatMovesTheAxis) {
  for (const double standing_N : {-0.9 * kFriction_N, 0.0, 0.5 * kFriction_N}) {
    LoadedAxis axis;
    axis.stand(3.0, standing_N);
    axis.swing(0.9, 2.0);
    EXPECT_LT(std::abs(axis.load.atRest_N() - kWeight_N - kBeside_N), 0.8 * kFriction_N) << standing_N;
  }
}

TEST(CarriedLoad, StaysWhenAPayloadIsDeclaredAndFollowsTheWeightOfAnotherPlace) {
  LoadedAxis axis;
  axis.stand(3.0, 0.0);
  axis.swing(4.0, 2.0);
  const double before_N = axis.load.atRest_N();
  axis.command.weight_N += 30.0;
  axis.command.declared_N += 30.0;
  axis.load.follow(axis.command);
  EXPECT_NEAR(axis.load.atRest_N(), before_N, 1e-9);
  axis.command.weight_N -= 50.0;
  for (int k = 0; k < 500; ++k)
    axis.load.learn(axis.command, axis.command.weight_N + kBeside_N - 30.0, 0.0, kDt);
  EXPECT_NEAR(axis.load.atRest_N(), before_N - 50.0, 3.0);
}

TEST(CarriedLoad, GoesWithThePlaceAsAMassDoesAndStaysWhenNobodyKnowsThePlaceAnyMore) {
  LoadedAxis axis;
  axis.command.per_kg_N = 5.0;
  axis.stand(3.0, 0.0);
  axis.load.addMass(8.0, 5.0);
  axis.stand(0.1, 0.0);
  EXPECT_NEAR(axis.load.beside_N(), 0.0, 0.5);
  axis.command.at_rest = false;
  axis.command.per_kg_N = 4.0;
  axis.command.reference_velocity = 0.05;
  for (int k = 0; k < 50; ++k)
    axis.load.learn(axis.command, kWeight_N + 8.0 * 4.0, 0.0, kDt);
  const double before_N = axis.load.atRest_N();
  EXPECT_NEAR(before_N, kWeight_N + 32.0, 0.5);
  axis.command.declared_N -= axis.command.weight_N;
  axis.command.weight_N = axis.command.per_kg_N = 0.0;
  axis.load.follow(axis.command);
  axis.load.learn(axis.command, before_N, 0.0, kDt);
  EXPECT_NEAR(axis.load.atRest_N(), before_N, 0.5);
}

/// Its weight changes with the place, and nobody foresees that.
TEST(CarriedLoad, WithoutAModelFollowsWhatTheDriveGives) {
  AxisCommand command;
  CarriedLoad load;
  command.force_N = 120.0;
  load.begin(command);
  EXPECT_EQ(load.atRest_N(), 120.0);
  command.at_rest = false;
  for (int k = 0; k < 1500; ++k)
    load.learn(command, 150.0, 0.0, kDt);
  EXPECT_NEAR(load.atRest_N(), 150.0, 2.0);
}

}  // namespace
}  // namespace knee_robot::control
