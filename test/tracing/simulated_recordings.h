#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "knee_robot/base/files.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/identification/accuracy.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "knee_robot/tracing/trace.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::tracing {

/// Longest way over which some element builds up, m; 0 when all are smooth.
inline double longestWidth(const dynamics::FrictionLaw& law) {
  double longest = 0.0;
  for (int k = 0; k < law.count; ++k) {
    const dynamics::FrictionElement& e = law.elements[static_cast<std::size_t>(k)];
    if (e.kind != dynamics::FrictionKind::Smooth) longest = std::max(longest, e.width_m);
  }
  return longest;
}

/// Robot B with its simulator, as scripts and launch files use them.
inline mechanism::Robot simulatedRobot() {
  return mechanism::configuredRobot("B");
}

constexpr int kWithStops = 100;  ///< added to a variant: along the same way, but standing for 1.5 s of every 4

inline double smoothStep(double edge) {
  return edge * edge * edge * (10.0 - 15.0 * edge + 6.0 * edge * edge);
}

/// How far along its way a reference with stops is.
inline double withStops(double t_s) {
  constexpr double kCycle_s = 4.0, kMoves_s = 2.5;
  const double cycle = std::floor(t_s / kCycle_s);
  return kMoves_s * (cycle + smoothStep(std::min(1.0, (t_s - cycle * kCycle_s) / kMoves_s)));
}

/// A reference of `seconds` along sines of the pose, at rest at both ends; `variant` makes another trajectory.
inline trajectory::Reference sineReference(const mechanism::Robot& robot, int variant, double seconds) {
  const bool stops = variant >= kWithStops;
  const double way = stops ? variant - kWithStops : variant;
  const double f = 1.0 + 0.23 * way, p = 0.9 * way;
  const double center[] = {0.02, 0.78, 0.05, 0.0}, amplitude[] = {0.05, 0.06, 0.14, 0.12};
  const double hz[] = {0.11, 0.09, 0.13, 0.10};
  trajectory::Reference reference;
  reference.name = "sines";
  reference.points.resize(static_cast<Eigen::Index>(seconds / trajectory::kStreamPeriod), 4);
  for (Eigen::Index k = 0; k < reference.points.rows(); ++k) {
    const double t = trajectory::kStreamPeriod * static_cast<double>(k);
    const double fade = smoothStep(std::min(1.0, std::min(t, seconds - t) / 3.0));
    const double along = stops ? withStops(t) : t;
    mechanism::Pose pose;
    for (int i = 0; i < 4; ++i) {
      const double w = 2.0 * M_PI * hz[i] * f;
      pose[i] = center[i] +
                fade * amplitude[i] * (0.75 * std::sin(w * along + p + i) + 0.25 * std::sin(2.7 * w * along + 2.0 * p));
    }
    reference.points.row(k) = mechanism::legLengths(*robot.mechanism, pose).transpose();
  }
  return reference;
}

/// The controller's feedforward: a model file (empty: the URDF's weights), and the share of every part.
struct FedForward {
  std::string model;
  double share = 1.0;
};

/// What the controller records when the simulated robot plays sineReference. `effects`: entries of the simulation
/// file's list.
inline recording::Recording simulatedRecording(const mechanism::Robot& robot, int variant, double seconds,
                                               const std::string& effects, const FedForward& feedforward = {}) {
  const auto require = [](const control::Answer& answer) {
    if (!answer.ok) throw std::runtime_error(answer.sentence);
  };
  const std::string source = KNEE_SOURCE_DIR;
  std::string simulation = readFile(source + "/config/simulation/B.yaml");
  if (!effects.empty()) simulation += "effects:\n" + effects;
  const std::string path =
      testing::TempDir() + "traced_" + std::to_string(getpid()) + "_" + std::to_string(variant) + ".csv";
  std::remove(path.c_str());
  // The give of a hidden flexible coupling is no brake that slips.
  std::string deployment = readFile(source + "/config/deployment/simulation.yaml");
  for (const auto& [component, property] :
       {std::pair{"Supervisor", "brake_test_N: 0"}, std::pair{"AxesOutput", "slip_m: 0.01"}}) {
    const std::string line = std::string("type: ") + component + ", activity: servo";
    deployment.insert(deployment.find(line) + line.size(), std::string(", properties: {") + property + "}");
  }
  // Questions to the encoders on the way to the start would let friction begin the recording elsewhere.
  const std::string asks = "derivative_cutoff_hz: 100}", silent = "derivative_cutoff_hz: 100, probe_s: 0}";
  for (std::size_t at = deployment.find(asks); at != std::string::npos; at = deployment.find(asks, at + silent.size()))
    deployment.replace(at, asks.size(), silent);
  const std::string deployment_path = path + ".yaml";
  writeFileAtomically(deployment_path, deployment);
  simulation::RobotImage image;
  simulation::RobotSimulation plant(robot, dynamics::loadRobotInertia(robot),
                                    simulation::parseSimulationParameters(simulation, "simulation"), image);
  const std::unique_ptr<hardware::AxisBus> bus = simulation::openImageCards(image);
  control::ControlSystem::Options options;
  options.execution = rt::Execution::Stepped;
  options.empty = true;
  options.model = feedforward.model;
  {
    control::ControlSystem system(robot, control::loadHardwareFile(source + "/config/hardware/simulated.yaml"),
                                  deployment_path, *bus, options);
    system.setPlant([&](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time))
        plant.step(0.001);
    });
    const auto hold = [&] {
      if (!system.waitFor(control::MachineState::Holding, 600.0))
        throw std::runtime_error(system.status().fault_sentence);
    };
    require(system.start());
    for (const char* part : {"share_gravity", "share_inertia", "share_friction"}) {
      if (feedforward.share < 1.0) require(system.setProperty("Feedforward", part, std::to_string(feedforward.share)));
    }
    require(system.loadReference(sineReference(robot, variant, seconds)));
    require(system.enable());
    require(system.approach());
    hold();
    require(system.startRecording(path));
    require(system.play());
    hold();
    require(system.stopRecording());
    require(system.shutdown());
  }
  recording::Recording recording = recording::loadRecording(path);
  std::remove(path.c_str());
  std::remove(deployment_path.c_str());
  return recording;
}

/// A robot with these effects, traced on one path, or several, and validated on another.
struct TracedCase {
  TraceResult result;
  Eigen::VectorXd before_N, after_N;  ///< rms on the other path, all samples
};

/// `change` is applied to all recordings; `trained`: variants of sineReference, not `validated`.
inline TracedCase traceSimulated(
    const std::string& effects, const std::function<void(recording::Recording&)>& change = [](recording::Recording&) {},
    const std::vector<int>& trained = {1}, int validated = 2) {
  constexpr double kSeconds = 30.0;
  const mechanism::Robot robot = simulatedRobot();
  TraceOptions options;
  options.surrogates = 5;
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  std::vector<recording::Recording> train;
  std::vector<identification::Observation> observed;
  for (const int variant : trained) {
    train.push_back(simulatedRecording(robot, variant, kSeconds, effects));
    change(train.back());
    observed.push_back(identification::observe(robot, columns, train.back(), options.observation));
  }
  recording::Recording second = simulatedRecording(robot, validated, kSeconds, effects);
  change(second);
  identification::Observation other = identification::observe(robot, columns, second, options.observation);
  TracedCase c;
  c.result = trace(robot, train, observed, options);
  const double cutoff_hz = options.observation.cutoff_hz;
  c.before_N = identification::accuracyOf(
                   {other}, {identification::makePrediction(other, predictBaseline(c.result, other), cutoff_hz)})
                   .rms_N;
  c.after_N =
      identification::accuracyOf(
          {other}, {identification::makePrediction(
                       other, predictTraced(robot, c.result, other, -1, static_cast<int>(train.size())), cutoff_hz)})
          .rms_N;
  return c;
}

/// By this name; null: there is none.
inline const FoundEffect* foundIn(const TracedCase& c, const std::string& name) {
  for (const FoundEffect& e : c.result.effects) {
    if (e.hypothesis.place.candidate->name() == name) return &e;
  }
  return nullptr;
}

}  // namespace knee_robot::tracing
