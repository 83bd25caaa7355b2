// benchmark: how long the functions of the real-time path take (Google Benchmark; --benchmark_format=json).
// One thread, the final geometry, a fixed set of random motions. scripts/benchmark_peers compares with other engines.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <iostream>
#include <random>
#include <vector>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/control/control_law.h"
#include "knee_robot/dynamics/force_parts.h"
#include "knee_robot/dynamics/forward_dynamics.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/mechanism/constraints.h"
#include "knee_robot/mechanism/singularity.h"

namespace {

using namespace knee_robot;

constexpr std::size_t kStates = 256;  // a power of two: cheap to cycle through, too many to predict

mechanism::Mechanism finalGeometry() {
  return mechanism::Mechanism(
      {{0.4, 0.4, 0.4}, 0.15, 90 * kDegree, 45 * kDegree, {0.3, 0.3, 0.3}, 50 * kDegree, 90 * kDegree});
}

dynamics::RobotInertia someInertia() {
  dynamics::RobotInertia inertia;
  for (int leg = 0; leg < mechanism::kLegs; ++leg) {
    inertia.links[dynamics::cylinderLink(leg)] = {
        2.5, {0.02, 0.2, 0.0}, mechanism::Vector3(0.04, 0.002, 0.04).asDiagonal()};
    inertia.links[dynamics::rodLink(leg)] = {
        0.8, {0.0, 0.0, -0.25}, mechanism::Vector3(0.02, 0.02, 0.0001).asDiagonal()};
  }
  inertia.links[dynamics::kPlatformLink] = {9.0, {0.02, 0.01, 0.03}, mechanism::Vector3(0.2, 0.2, 0.4).asDiagonal()};
  inertia.rotor_mass.setConstant(5.6);
  return inertia;
}

/// What all cases share.
struct Cases {
  Cases() : mechanism(finalGeometry()), model(mechanism, mechanism::Vector3(0.0, 0.0, -9.81), someInertia()) {
    std::mt19937 engine(1);
    const auto uniform = [&engine](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(engine);
    };
    while (motions.size() < kStates) {
      mechanism::Motion m;
      m.pose = mechanism::Pose(uniform(-0.1, 0.1), uniform(0.55, 0.8), uniform(-0.3, 0.3), uniform(-0.3, 0.3));
      if (mechanism::conditionNumber(mechanism, m.pose) > 60.0) continue;
      for (int j = 0; j < 4; ++j) {
        m.pose_velocity[j] = uniform(-0.3, 0.3);
        m.pose_acceleration[j] = uniform(-1.0, 1.0);
      }
      motions.push_back(m);
      lengths.push_back(mechanism::legLengths(mechanism, m.pose));
      // As in a control loop: the last pose, 1 ms at 0.2 m/s away.
      guesses.push_back(m.pose + 1e-3 * m.pose_velocity);
    }
  }
  const mechanism::Motion& motion(std::size_t k) const { return motions[k % kStates]; }

  mechanism::Mechanism mechanism;
  dynamics::RigidModel model;
  std::vector<mechanism::Motion> motions;
  std::vector<mechanism::Lengths> lengths;
  std::vector<mechanism::Pose> guesses;
};

const Cases& cases() {
  static const Cases all;
  return all;
}

void inverseKinematicsCase(benchmark::State& state) {
  const Cases& c = cases();
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(mechanism::inverseKinematics(c.mechanism, c.motion(k++).pose));
}
BENCHMARK(inverseKinematicsCase)->Name("inverse_kinematics");

void forwardKinematicsCase(benchmark::State& state) {
  const Cases& c = cases();
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(mechanism::forwardKinematics(c.mechanism, c.lengths[k % kStates], c.guesses[k % kStates]));
    ++k;
  }
}
BENCHMARK(forwardKinematicsCase)->Name("forward_kinematics");

void motionFromLengthsCase(benchmark::State& state) {
  const Cases& c = cases();
  const mechanism::Vector4 velocity = mechanism::Vector4::Constant(0.1),
                           acceleration = mechanism::Vector4::Constant(0.5);
  mechanism::Motion motion;
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(mechanism::motionFromLengths(c.mechanism, c.lengths[k % kStates], velocity, acceleration,
                                                          c.guesses[k % kStates], motion));
    ++k;
  }
}
BENCHMARK(motionFromLengthsCase)->Name("motion_from_lengths");

void inverseDynamicsCase(benchmark::State& state) {
  const Cases& c = cases();
  mechanism::Vector4 forces;
  std::size_t k = 0;
  for (auto _ : state) {
    dynamics::inverseDynamics(c.model, c.motion(k++), forces);
    benchmark::DoNotOptimize(forces);
  }
}
BENCHMARK(inverseDynamicsCase)->Name("inverse_dynamics");

void forwardDynamicsCase(benchmark::State& state) {
  const Cases& c = cases();
  const mechanism::Vector4 forces = mechanism::Vector4::Constant(50.0);
  dynamics::ForwardDynamicsData data;
  std::size_t k = 0;
  for (auto _ : state) {
    const mechanism::Motion& m = c.motion(k++);
    dynamics::forwardDynamics(c.model, m.pose, m.pose_velocity, forces, data);
    benchmark::DoNotOptimize(data.acceleration);
  }
}
BENCHMARK(forwardDynamicsCase)->Name("forward_dynamics");

void projectedRegressorCase(benchmark::State& state) {
  const Cases& c = cases();
  dynamics::RegressorData data;
  std::size_t k = 0;
  for (auto _ : state) {
    dynamics::projectedRegressor(c.mechanism, c.model.gravity, c.motion(k++), data);
    benchmark::DoNotOptimize(data.k);
  }
}
BENCHMARK(projectedRegressorCase)->Name("projected_regressor");

void extendedRegressorCase(benchmark::State& state) {
  const Cases& c = cases();
  dynamics::RegressorData data;
  dynamics::ExtendedRegressor result;
  std::size_t k = 0;
  for (auto _ : state) {
    dynamics::extendedRegressor(c.mechanism, c.model.gravity, c.motion(k++), data, result);
    benchmark::DoNotOptimize(result);
  }
}
BENCHMARK(extendedRegressorCase)->Name("extended_regressor");

void forcePartsCase(benchmark::State& state) {
  const Cases& c = cases();
  mechanism::Robot robot;
  robot.mechanism = c.mechanism;
  robot.actuators.resize(mechanism::kLegs);
  dynamics::PartedModel model(robot, someInertia());
  model.knows_motion = true;  // as an identified model: inertia and friction, too
  const mechanism::Vector4 velocity = mechanism::Vector4::Constant(0.02),
                           acceleration = mechanism::Vector4::Constant(0.1);
  dynamics::ForcePartsData data;
  dynamics::ForceParts parts;
  std::size_t k = 0;
  for (auto _ : state) {
    dynamics::forceParts(model, c.motion(k++).pose, velocity, acceleration, 2e-4, data, parts);
    benchmark::DoNotOptimize(parts);
  }
}
BENCHMARK(forcePartsCase)->Name("force_parts");

/// What passivity-based control costs beyond force_parts: two inverse dynamics with an auxiliary velocity.
void controlLawCase(benchmark::State& state) {
  const Cases& c = cases();
  mechanism::Robot robot;
  robot.mechanism = c.mechanism;
  robot.actuators.resize(mechanism::kLegs);
  const dynamics::PartedModel model(robot, someInertia());
  control::ControlLaw law;
  law.choose(control::Law::PassivityBased);
  control::ControlLaw::Instant at;
  at.velocity.setConstant(0.02);
  at.acceleration.setConstant(0.1);
  at.dt = 0.001;
  mechanism::Vector4 force;
  std::size_t k = 0;
  for (auto _ : state) {
    at.position = at.reference = c.lengths[k % kStates];
    at.pose = c.motion(k++).pose;
    law.force(model, {4000.0, 125.0, 20.0, 100.0}, at, force);
    benchmark::DoNotOptimize(force);
  }
}
BENCHMARK(controlLawCase)->Name("control_law");

/// A model of trace with ten effects, those that cost most among them.
dynamics::Model tracedModel() {
  dynamics::Model model;
  model.axes = mechanism::kLegs;
  model.friction.assign(mechanism::kLegs, dynamics::bristleLaw(1e-4, 1e-5));
  const dynamics::InertialParameters links = dynamics::toParameters(someInertia());
  for (const std::string& name : dynamics::extendedParameterNames()) {
    dynamics::ModelParameter parameter;
    parameter.name = name;
    const auto k = static_cast<Eigen::Index>(model.parameters.size());
    parameter.value = k < links.size() ? links[k] : 20.0;
    model.parameters.push_back(parameter);
    model.effects_see.push_back(parameter.value);
  }
  const auto add = [&](const char* name, int actuator, const std::vector<double>& shape, int coefficients,
                       const char* depends_on = "") {
    dynamics::ModelEffect effect;
    effect.name = name;
    effect.depends_on = depends_on;
    effect.actuators = {actuator};
    for (const double value : shape)
      effect.shape.push_back({"shape", value});
    for (int k = 0; k < coefficients; ++k)
      effect.coefficients.push_back({"coefficient", 0.01});
    model.effects.push_back(effect);
  };
  add("stribeck", 1, {0.006}, 1);
  add("presliding", 2, {1e-3}, 1);
  add("power_flow_friction", 3, {}, 4);
  add("position_dependent_friction", 4, {0.7, 0.05, 0.6, 0.8}, 1);
  add("screw_ripple", 1, {0.01, 0.0}, 2);
  add("thermal_drift", 2, {40.0}, 2);
  add("delay", 3, {}, 1);  // the whole model a second time, for the force to come
  add("spring", 1, {0.3, 0.0, 0.1, 0.0}, 2);
  add("dashpot", 1, {0.0, 0.3, 0.0, 0.1, 0.5}, 1);
  add("unnamed", 4, {-1.0, -0.5, 0.0, 0.5, 1.0}, 5, "leg_4_angle_q1_rad");
  return model;
}

void forcePartsWithEffectsCase(benchmark::State& state) {
  const Cases& c = cases();
  mechanism::Robot robot;
  robot.mechanism = c.mechanism;
  robot.actuators.resize(mechanism::kLegs);
  const dynamics::PartedModel model(tracedModel(), robot);
  dynamics::ForcePartsData data;
  dynamics::ForceParts parts;
  dynamics::WantedInstant at;
  at.acceleration_m_per_s2.setConstant(0.1);
  std::size_t k = 0;
  for (auto _ : state) {
    at.position_m = c.lengths[k % kStates];
    at.velocity_m_per_s.setConstant(k % 64 < 32 ? 0.02 : -0.02);
    dynamics::forceParts(model, c.motion(k++).pose, at, data, parts);
    benchmark::DoNotOptimize(parts);
  }
}
BENCHMARK(forcePartsWithEffectsCase)->Name("force_parts_ten_effects");

void coordinateMotionCase(benchmark::State& state) {
  const Cases& c = cases();
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(mechanism::coordinateMotion(c.mechanism, c.motion(k++)));
}
BENCHMARK(coordinateMotionCase)->Name("all_15_coordinates");

void singularityCase(benchmark::State& state) {
  const Cases& c = cases();
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(mechanism::singularityAt(c.mechanism, c.motion(k++).pose));
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
