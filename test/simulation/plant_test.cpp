#include "knee_robot/simulation/plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "test/simulation/plant_bench.h"

namespace knee_robot::simulation {
namespace {

const mechanism::Pose kLevel(0.0, 0.65, 0.0, 0.0);

PlantState at(const mechanism::Pose& pose, const mechanism::Vector4& velocity = mechanism::Vector4::Zero()) {
  PlantState state;
  state.pose = pose;
  state.pose_velocity = velocity;
  return state;
}

/// In motion in all four coordinates with this kinetic energy.
PlantState moving(const PlantModel& model, double energy_J) {
  const mechanism::Pose pose(0.05, 0.65, 0.1, -0.1);
  const mechanism::Vector4 direction(0.4, 0.5, 0.7, 0.9);
  return at(pose, direction * std::sqrt(energy_J / dynamics::kineticEnergy(model.rigid, pose, direction)));
}

/// Largest energy drift (J) during 2 s of free motion, accurate and real-time integrator.
void runFree(const PlantModel& model, const char* name, double& accurate_drift, double& real_time_drift) {
  const PlantState start = moving(model, 45.0);
  const double energy = totalEnergy(model, start);
  const PlantLoads free;
  PlantData data;
  PlantState accurate = start;
  PlantState real_time = start;
  accurate_drift = real_time_drift = 0.0;
  double kinetic_min = 1e9, kinetic_max = 0.0;
  for (int i = 0; i < 2000; ++i) {
    for (int k = 0; k < 4; ++k)
      ASSERT_TRUE(stepFrictionless(model, free, 0.25e-3, accurate, data));
    ASSERT_TRUE(stepPlant(model, free, 1e-3, real_time, data));
    accurate_drift = std::max(accurate_drift, std::abs(totalEnergy(model, accurate) - energy));
    real_time_drift = std::max(real_time_drift, std::abs(totalEnergy(model, real_time) - energy));
    const double kinetic = dynamics::kineticEnergy(model.rigid, accurate.pose, accurate.pose_velocity);
    kinetic_min = std::min(kinetic_min, kinetic);
    kinetic_max = std::max(kinetic_max, kinetic);
  }
  std::printf("%s, 2 s from 45 J of motion: kinetic energy %.1f to %.1f J, drift %.1e J accurate, %.1e J real-time\n",
              name, kinetic_min, kinetic_max, accurate_drift, real_time_drift);
}

// Without friction nothing holds the legs: with gravity the robot falls, far beyond any real stroke, and its energy
// multiplies.
TEST(Plant, ConservesEnergyInFreeMotion) {
  PlantModel model = plantOf("final");
  double accurate = 0.0, real_time = 0.0;
  runFree(model, "falling", accurate, real_time);
  EXPECT_LT(accurate, 1e-6);
  EXPECT_LT(real_time, 1e-2);
  model.rigid.gravity.setZero();
  runFree(model, "weightless", accurate, real_time);
  EXPECT_LT(accurate, 1e-6);
  EXPECT_LT(real_time, 1e-2);
}

TEST(Plant, IsOfSecondOrderWhereMotionIsSmooth) {
  PlantModel model = plantOf("final");
  PlantLoads loads;
  loads.viscous.setConstant(50.0);
  const auto endPose = [&](int substeps) {
    model.substeps = substeps;
    PlantState state = moving(model, 45.0);
    PlantData data;
    for (int i = 0; i < 200; ++i)
      EXPECT_TRUE(stepPlant(model, loads, 1e-3, state, data));
    return state.pose;
  };
  const mechanism::Pose exact = endPose(64);
  const double coarse = (endPose(1) - exact).norm();
  const double fine = (endPose(2) - exact).norm();
  std::printf("error after 0.2 s: %.2e at 1 ms, %.2e at 0.5 ms\n", coarse, fine);
  EXPECT_NEAR(coarse / fine, 4.0, 0.5);
}

TEST(Plant, StaysAtRestToTheLastBitBelowItsCoulombForces) {
  for (const char* name : {"final", "B"}) {
    const PlantModel model = plantOf(name);
    const PlantState start = at(mechanism::Pose(0.03, 0.68, 0.05, -0.04));
    PlantLoads loads;
    loads.coulomb = 1.001 * holdingForces(model, start.pose).cwiseAbs();
    PlantState state = start;
    PlantData data;
    for (int i = 0; i < 10000; ++i)
      ASSERT_TRUE(stepPlant(model, loads, 1e-3, state, data));
    EXPECT_EQ(state.pose, start.pose) << name;
    EXPECT_EQ(state.pose_velocity, mechanism::Vector4(mechanism::Vector4::Zero())) << name;
    EXPECT_NEAR((data.friction_force - holdingForces(model, start.pose)).norm(), 0.0, 1e-8);
  }
}

TEST(Plant, StartsToMoveAboveItsCoulombForce) {
  const PlantModel model = plantOf("final");
  const PlantState start = at(kLevel);
  const mechanism::Vector4 holding = holdingForces(model, start.pose);
  for (int axis = 0; axis < mechanism::kLegs; ++axis) {
    PlantLoads loads;
    loads.coulomb = 1.001 * holding.cwiseAbs();
    loads.coulomb[axis] = 0.98 * std::abs(holding[axis]);
    PlantState state = start;
    PlantData data;
    for (int i = 0; i < 200; ++i)
      ASSERT_TRUE(stepPlant(model, loads, 1e-3, state, data));
    const mechanism::Lengths moved = mechanism::legLengths(model.rigid.mechanism, state.pose) -
                                     mechanism::legLengths(model.rigid.mechanism, start.pose);
    EXPECT_LT(moved[axis] * holding[axis], 0.0) << axis;  // gives way to the load
    EXPECT_GT(std::abs(moved[axis]), 1e-6) << axis;
  }
}

TEST(Plant, KeepsTheOtherThreeLengthsWhileOneAxisMoves) {
  const PlantModel model = plantOf("final");
  const PlantState start = at(kLevel);
  PlantLoads loads;
  loads.coulomb.setConstant(2000.0);
  loads.coulomb[1] = 0.0;
  loads.viscous[1] = 1000.0;
  loads.motor_force[1] = holdingForces(model, start.pose)[1] + 100.0;  // about 0.1 m/s
  PlantState state = start;
  PlantData data;
  for (int i = 0; i < 500; ++i)
    ASSERT_TRUE(stepPlant(model, loads, 1e-3, state, data));
  const mechanism::Lengths moved = mechanism::legLengths(model.rigid.mechanism, state.pose) -
                                   mechanism::legLengths(model.rigid.mechanism, start.pose);
  std::printf("moved %.4f m; the held lengths crept by %.1e, %.1e, %.1e m\n", moved[1], moved[0], moved[2], moved[3]);
  EXPECT_GT(moved[1], 0.02);
  for (const int axis : {0, 2, 3})
    EXPECT_LT(std::abs(moved[axis]), 1e-7);  // a fiftieth of an encoder count
}

TEST(Plant, BalancesPowerWithFriction) {
  const PlantModel model = plantOf("final");
  PlantState state = at(kLevel);
  PlantData data;
  double work = 0.0, dissipated = 0.0, largest_loss = 0.0;
  const double before = totalEnergy(model, state);
  int reversals = 0;
  mechanism::Vector4 last_rate = mechanism::Vector4::Zero();
  for (int i = 0; i < 3000; ++i) {
    PlantLoads loads;
    const double t = 1e-3 * i;
    loads.viscous = mechanism::Vector4(150, 150, 150, 400);
    loads.coulomb = mechanism::Vector4(15, 15, 15, 60);
    loads.motor_force =
        holdingForces(model, state.pose) +
        mechanism::Vector4(60 * std::sin(5 * t), 70 * std::sin(6 * t), 50 * std::sin(7 * t), 120 * std::sin(4 * t));
    ASSERT_TRUE(stepPlant(model, loads, 1e-3, state, data));
    work += data.motor_work_J;
    dissipated += data.dissipated_J;
    ASSERT_GE(data.dissipated_J, -1e-12);  // friction never drives
    const mechanism::Vector4 rate = mechanism::lengthJacobian(model.rigid.mechanism, state.pose) * state.pose_velocity;
    for (int axis = 0; axis < mechanism::kLegs; ++axis)
      reversals += rate[axis] * last_rate[axis] < 0.0 || rate[axis] == 0.0;
    last_rate = rate;
    const double gained = totalEnergy(model, state) - before;
    largest_loss = std::max(largest_loss, std::abs(work - gained - dissipated));
  }
  std::printf("3 s: motor work %.3f J, dissipated %.3f J, stops and reversals %d, books open by at most %.1e J\n", work,
              dissipated, reversals, largest_loss);
  EXPECT_GT(dissipated, 1.0);
  EXPECT_GT(reversals, 10);
  EXPECT_LT(largest_loss, 1e-4 * dissipated);
}

TEST(Plant, ComesToRestOnItsStops) {
  PlantModel model = plantOf("final");
  PlantState state = at(kLevel);
  const mechanism::Lengths start = mechanism::legLengths(model.rigid.mechanism, state.pose);
  model.shortest_m = start - mechanism::Lengths::Constant(0.02);
  model.longest_m = start + mechanism::Lengths::Constant(0.02);
  PlantLoads loads;
  loads.coulomb.setConstant(1.0);
  PlantData data;
  for (int i = 0; i < 2000; ++i)
    ASSERT_TRUE(stepPlant(model, loads, 1e-3, state, data));
  const mechanism::Lengths end = mechanism::legLengths(model.rigid.mechanism, state.pose);
  for (int axis = 0; axis < mechanism::kLegs; ++axis) {
    EXPECT_GT(end[axis], model.shortest_m[axis] - 1e-3);
    EXPECT_LT(end[axis], model.longest_m[axis] + 1e-3);
  }
  EXPECT_EQ(state.pose_velocity, mechanism::Vector4(mechanism::Vector4::Zero()));
  EXPECT_LT(state.pose[1], 0.645);  // it did fall
}

TEST(Plant, BrakesAStrongShortCircuitWithoutOscillating) {
  const PlantModel model = plantOf("final");
  PlantState state = at(kLevel);
  PlantLoads loads;
  loads.viscous.setConstant(1e6);  // far beyond the 1240 N s/m of shorted windings: the step must not care
  PlantData data;
  double last_height = state.pose[1];
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(stepPlant(model, loads, 1e-3, state, data));
    ASSERT_LE(state.pose[1], last_height + 1e-12);
    last_height = state.pose[1];
  }
  EXPECT_LT(kLevel[1] - last_height, 1e-3);
}

}  // namespace
}  // namespace knee_robot::simulation
