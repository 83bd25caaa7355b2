// What false_trips drives: the stepped controller on a simulated robot, as eight machines that nobody told it of.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "../control/some_model.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/control/disturbance_sentences.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"

namespace knee_robot::control::stepped {

/// A machine as somebody may have it: effects of docs/tracing.md, in the simulation file's words, and a payload nobody
/// declared.
struct Machine {
  const char* name;
  const char* effects;
  double payload_kg;
};
inline const char* const kStribeck =
    "  - {name: stribeck, actuators: [1, 2, 3, 4], excess_N: 20, velocity_m_per_s: 0.004}\n";
inline const char* const kBristles =
    "  - {name: presliding, actuators: [1, 2, 3, 4], stiffness_N_per_m: 3e5, damping_N_s_per_m: 300}\n";
inline const Machine kMachines[] = {
    {"as identified", "", 0.0},
    {"15 kg undeclared", "", 15.0},
    {"stribeck, 20 N more at rest", kStribeck, 0.0},
    {"bristles", kBristles, 0.0},
    {"warms up: friction +50 %",
     "  - {name: thermal_drift, actuators: [1, 2, 3, 4], viscous_change: 0.5, coulomb_change: 0.5, time_constant_s: "
     "60}\n",
     0.0},
    {"load-dependent friction 10 %", "  - {name: load_dependent_friction, actuators: [1, 2, 3, 4], share: 0.1}\n",
     15.0},
    {"screw ripple 8 N",
     "  - {name: screw_ripple, actuators: [1, 2, 3, 4], amplitude_N: 8, period_m: 0.01, phase_deg: 30}\n", 0.0},
    {"asymmetric 20 N, 15 kg", "  - {name: asymmetric_coulomb, actuators: [1, 2, 3, 4], difference_N: 20}\n", 15.0},
};

inline std::string file(const std::string& name) {
  return std::string(KNEE_SOURCE_DIR) + "/" + name;
}

inline double probe_period = 0.6;
inline double rest_question = 30.0;
inline bool watch_warnings = false;

/// The deployment of the simulated robot, its test pulses every `probe_s` (0: none). Stepped, nothing is late: the
/// monitors of motion are those of a real machine.
inline std::string deployment(double probe_s) {
  std::string text = readFile(file("config/deployment/simulation.yaml"));
  for (const char* axis : {"{axis: 1,", "{axis: 2,", "{axis: 3,", "{axis: 4,"})
    text.replace(text.find(axis), 9, std::string(axis) + " probe_s: " + std::to_string(probe_s) + ",");
  const std::string observer = "type: DisturbanceObserver";
  text.insert(text.find(observer) + observer.size(),
              ", properties: {rest_question_s: " + std::to_string(rest_question) + "}");
  const std::string wide =
      ", acceleration_factor: 100, velocity_s: 0.05, jump_factor: 8, jump_acceleration_m_per_s2: 1.0e6";
  text.erase(text.find(wide), wide.size());
  const std::string path = "/tmp/false_trips_" + std::to_string(::getpid()) + ".yaml";
  writeFileAtomically(path, text);
  return path;
}

/// A model file of robot and machine as they are; the residual that it promises is 1 N.
inline std::string trueModel(const mechanism::Robot& robot, const simulation::SimulationParameters& machine) {
  dynamics::Model model = fake::modelOf(robot);
  for (std::size_t i = 0; i < mechanism::kLegs; ++i) {
    model.parameters[dynamics::extended::kViscous + i].value = machine.axes[i].viscous_N_s_per_m;
    model.parameters[dynamics::extended::kCoulomb + i].value = machine.axes[i].coulomb_N;
    model.parameters[dynamics::extended::kRotor + i].value = machine.axes[i].rotor_mass_kg;
  }
  const std::string path = "/tmp/false_trips_model_" + std::to_string(::getpid()) + ".yaml";
  dynamics::saveModel(model, path);
  return path;
}

class Rig {
 public:
  Rig(const std::string& name, const Machine& machine)
      : robot(mechanism::loadRobot(file("config/robots/" + name + ".yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot), parameters(name, machine), image),
        bus(simulation::openImageCards(image)) {
    ControlSystem::Options options;
    options.execution = rt::Execution::Stepped;
    options.empty = true;
    if (watch_warnings) options.model = trueModel(robot, parameters(name, machine));
    system = std::make_unique<ControlSystem>(robot, loadHardwareFile(file("config/hardware/simulated.yaml")),
                                             deployment(probe_period), *bus, options);
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time)) {
        plant.step(0.001);
        lowest = std::min(lowest, plant.state().pose[1]);
      }
      if (watch_warnings && ++cycles_ % 100 == 0) listen();
    });
    const Answer started = system->start();
    if (!started.ok) throw InputError(started.sentence);
    home = plant.state().pose;
  }
  bool hold() { return system->state() == MachineState::Holding || system->enable().ok; }
  /// From where the robot stands to `pose` in `seconds`, rest to rest, at `speed` percent. False: refused, nothing
  /// moves.
  bool play(const mechanism::Pose& pose, double seconds) {
    const std::optional<TrackingRow> row = system->snapshot();
    const mechanism::Lengths from(row->reference_m.data());
    const mechanism::Lengths to = mechanism::legLengths(*robot.mechanism, pose);
    trajectory::Reference reference;
    reference.name = "way";
    const auto n = static_cast<Eigen::Index>(std::ceil(seconds / trajectory::kStreamPeriod));
    reference.points.resize(n + 1, 4);
    for (Eigen::Index k = 0; k <= n; ++k) {
      const double x = static_cast<double>(k) / static_cast<double>(n);
      reference.points.row(k) = (from + x * x * x * (10.0 + x * (6.0 * x - 15.0)) * (to - from)).transpose();
    }
    return system->loadReference(reference).ok && system->play().ok;
  }

  /// All legs to and fro in 12 s with periods of their own, height constant: many turning points.
  bool swing() {
    const std::optional<TrackingRow> row = system->snapshot();
    const mechanism::Lengths from(row->reference_m.data());
    const mechanism::Lengths beside = from - mechanism::legLengths(*robot.mechanism, home);
    const auto wave = [](int k, double period_s) { return 0.5 * (1.0 - std::cos(2.0 * M_PI * 0.01 * k / period_s)); };
    trajectory::Reference reference;
    reference.name = "swing";
    reference.points.resize(1201, 4);
    for (int k = 0; k <= 1200; ++k) {
      mechanism::Pose pose = home;
      pose[0] += 0.07 * wave(k, 2.4);
      pose[2] += 0.09 * wave(k, 3.0);
      pose[3] += 0.10 * wave(k, 2.0);
      reference.points.row(k) = (mechanism::legLengths(*robot.mechanism, pose) + beside).transpose();
    }
    return system->loadReference(reference).ok && system->play().ok;
  }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  std::unique_ptr<hardware::AxisBus> bus;
  mechanism::Pose home;
  double lowest = 10.0;
  std::map<std::string, int> warnings;

 private:
  /// Each sentence counts when it begins.
  void listen() {
    std::set<std::string> now;
    const std::optional<Disturbance> disturbance = system->disturbance();
    for (const Notice& notice : disturbance ? noticesOf(*disturbance) : std::vector<Notice>{})
      now.insert(notice.sentence.substr(0, notice.sentence.find_first_of(",:(")).substr(0, 40));
    for (const std::string& sentence : now)
      warnings[sentence] += said_.count(sentence) == 0 ? 1 : 0;
    said_ = now;
  }
  int cycles_ = 0;
  std::set<std::string> said_;

 public:
  std::unique_ptr<ControlSystem> system;  // last: it goes on stepping the plant while it shuts down

 private:
  static simulation::SimulationParameters parameters(const std::string& name, const Machine& machine) {
    std::string text = readFile(file("config/simulation/" + name + ".yaml"));
    if (*machine.effects != 0) text += std::string("effects:\n") + machine.effects;
    simulation::SimulationParameters all = simulation::parseSimulationParameters(text, machine.name);
    if (machine.payload_kg > 0.0) all.payload = simulation::Payload{machine.payload_kg, {0.0, 0.0, 0.1}, 0.1};
    return all;
  }
};

}  // namespace knee_robot::control::stepped
