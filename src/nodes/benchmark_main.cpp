// benchmark: how long the functions of the real-time path take (Google Benchmark; --benchmark_format=json).
// One thread, the final geometry, a fixed set of random motions. scripts/benchmark_peers compares with other engines.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <iostream>
#include <random>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/force_parts.h"
#include "knee_robot/dynamics/forward_dynamics.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/mechanism/constraints.h"
#include "knee_robot/mechanism/singularity.h"

namespace {

using namespace knee_robot;

constexpr std::size_t kStates = 256;  // a power of two: cheap to cycle through, too many to predict

Mechanism finalGeometry() {
  constexpr double kDegree = M_PI / 180.0;
  return Mechanism({{0.4, 0.4, 0.4}, 0.15, 90 * kDegree, 45 * kDegree, {0.3, 0.3, 0.3}, 50 * kDegree, 90 * kDegree});
}

RobotInertia someInertia() {
  RobotInertia inertia;
  for (int leg = 0; leg < kLegs; ++leg) {
    inertia.links[cylinderLink(leg)] = {2.5, {0.02, 0.2, 0.0}, Vector3(0.04, 0.002, 0.04).asDiagonal()};
    inertia.links[rodLink(leg)] = {0.8, {0.0, 0.0, -0.25}, Vector3(0.02, 0.02, 0.0001).asDiagonal()};
  }
  inertia.links[kPlatformLink] = {9.0, {0.02, 0.01, 0.03}, Vector3(0.2, 0.2, 0.4).asDiagonal()};
  inertia.rotor_mass.setConstant(5.6);
  return inertia;
}

/// What all cases share.
struct Cases {
  Cases() : mechanism(finalGeometry()), model(mechanism, Vector3(0.0, 0.0, -9.81), someInertia()) {
    std::mt19937 engine(1);
    const auto uniform = [&engine](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(engine);
    };
    while (motions.size() < kStates) {
      Motion m;
      m.pose = Pose(uniform(-0.1, 0.1), uniform(0.55, 0.8), uniform(-0.3, 0.3), uniform(-0.3, 0.3));
      if (conditionNumber(mechanism, m.pose) > 60.0) continue;
      for (int j = 0; j < 4; ++j) {
        m.pose_velocity[j] = uniform(-0.3, 0.3);
        m.pose_acceleration[j] = uniform(-1.0, 1.0);
      }
      motions.push_back(m);
      lengths.push_back(legLengths(mechanism, m.pose));
      // As in a control loop: the last pose, 1 ms at 0.2 m/s away.
      guesses.push_back(m.pose + 1e-3 * m.pose_velocity);
    }
  }
  const Motion& motion(std::size_t k) const { return motions[k % kStates]; }

  Mechanism mechanism;
  RigidModel model;
  std::vector<Motion> motions;
  std::vector<Lengths> lengths;
  std::vector<Pose> guesses;
};

const Cases& cases() {
  static const Cases all;
  return all;
}

void inverseKinematicsCase(benchmark::State& state) {
  const Cases& c = cases();
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(inverseKinematics(c.mechanism, c.motion(k++).pose));
}
BENCHMARK(inverseKinematicsCase)->Name("inverse_kinematics");

void forwardKinematicsCase(benchmark::State& state) {
  const Cases& c = cases();
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(forwardKinematics(c.mechanism, c.lengths[k % kStates], c.guesses[k % kStates]));
    ++k;
  }
}
BENCHMARK(forwardKinematicsCase)->Name("forward_kinematics");

void motionFromLengthsCase(benchmark::State& state) {
  const Cases& c = cases();
  const Vector4 velocity = Vector4::Constant(0.1), acceleration = Vector4::Constant(0.5);
  Motion motion;
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        motionFromLengths(c.mechanism, c.lengths[k % kStates], velocity, acceleration, c.guesses[k % kStates], motion));
    ++k;
  }
}
BENCHMARK(motionFromLengthsCase)->Name("motion_from_lengths");

void inverseDynamicsCase(benchmark::State& state) {
  const Cases& c = cases();
  Vector4 forces;
  std::size_t k = 0;
  for (auto _ : state) {
    inverseDynamics(c.model, c.motion(k++), forces);
    benchmark::DoNotOptimize(forces);
  }
}
BENCHMARK(inverseDynamicsCase)->Name("inverse_dynamics");

void forwardDynamicsCase(benchmark::State& state) {
  const Cases& c = cases();
  const Vector4 forces = Vector4::Constant(50.0);
  ForwardDynamicsData data;
  std::size_t k = 0;
  for (auto _ : state) {
    const Motion& m = c.motion(k++);
    forwardDynamics(c.model, m.pose, m.pose_velocity, forces, data);
    benchmark::DoNotOptimize(data.acceleration);
  }
}
BENCHMARK(forwardDynamicsCase)->Name("forward_dynamics");

void projectedRegressorCase(benchmark::State& state) {
  const Cases& c = cases();
  RegressorData data;
  std::size_t k = 0;
  for (auto _ : state) {
    projectedRegressor(c.mechanism, c.model.gravity, c.motion(k++), data);
    benchmark::DoNotOptimize(data.k);
  }
}
BENCHMARK(projectedRegressorCase)->Name("projected_regressor");

void extendedRegressorCase(benchmark::State& state) {
  const Cases& c = cases();
  RegressorData data;
  ExtendedRegressor result;
  std::size_t k = 0;
  for (auto _ : state) {
    extendedRegressor(c.mechanism, c.model.gravity, c.motion(k++), data, result);
    benchmark::DoNotOptimize(result);
  }
}
BENCHMARK(extendedRegressorCase)->Name("extended_regressor");

void forcePartsCase(benchmark::State& state) {
  const Cases& c = cases();
  Robot robot;
  robot.mechanism = c.mechanism;
  robot.actuators.resize(kLegs);
  PartedModel model(robot, someInertia());
  model.knows_motion = true;  // as an identified model: inertia and friction, too
  const Vector4 velocity = Vector4::Constant(0.02), acceleration = Vector4::Constant(0.1);
  ForcePartsData data;
  ForceParts parts;
  std::size_t k = 0;
  for (auto _ : state) {
    forceParts(model, c.motion(k++).pose, velocity, acceleration, 2e-4, data, parts);
    benchmark::DoNotOptimize(parts);
  }
}
BENCHMARK(forcePartsCase)->Name("force_parts");

void coordinateMotionCase(benchmark::State& state) {
  const Cases& c = cases();
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(coordinateMotion(c.mechanism, c.motion(k++)));
}
BENCHMARK(coordinateMotionCase)->Name("all_15_coordinates");

void singularityCase(benchmark::State& state) {
  const Cases& c = cases();
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(singularityAt(c.mechanism, c.motion(k++).pose));
}
BENCHMARK(singularityCase)->Name("singularity_measures");

}  // namespace

int main(int argc, char** argv) {
  const bool help = std::any_of(argv, argv + argc, [](const char* word) { return std::string(word) == "--help"; });
  if (help) {
    std::cout
        << "benchmark: times the functions of the real-time path, in ns a call\n"
           "Options are Google Benchmark's: --benchmark_filter=REGEX, --benchmark_format=json, --benchmark_out=FILE,\n"
           "--benchmark_repetitions=N, --benchmark_min_time=SECONDS, --benchmark_list_tests\n";
    return kExitDone;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return kExitBadInput;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return kExitDone;
}
