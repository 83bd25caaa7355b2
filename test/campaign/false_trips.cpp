// false_trips: how often the stepped controller stops a healthy robot in simulated hours of ordinary use, with friction that nobody told
// it of; with --warnings, what the disturbance observer says of a robot that is as its model says; and with --frozen, what becomes of an
// encoder that dies. scripts/false_trips starts it. Its figures are those of docs/results/faults.md.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
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

namespace knee_robot::control {
namespace {

/// A machine as somebody may have it: effects of docs/tracing.md, in the simulation file's words, and a payload nobody declared.
struct Machine {
  const char* name;
  const char* effects;
  double payload_kg;
};
const char* const kStribeck = "  - {name: stribeck, actuators: [1, 2, 3, 4], excess_N: 20, velocity_m_per_s: 0.004}\n";
const char* const kBristles =
    "  - {name: presliding, actuators: [1, 2, 3, 4], stiffness_N_per_m: 3e5, damping_N_s_per_m: 300}\n";
const Machine kMachines[] = {
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

std::string file(const std::string& name) {
  return std::string(KNEE_SOURCE_DIR) + "/" + name;
}

/// The deployment of the simulated robot, its test pulses every `probe_s` (0: none).
std::string deployment(double probe_s) {
  std::string text = readFile(file("config/deployment/simulation.yaml"));
  for (const char* axis : {"{axis: 1,", "{axis: 2,", "{axis: 3,", "{axis: 4,"})
    text.replace(text.find(axis), 9, std::string(axis) + " probe_s: " + std::to_string(probe_s) + ",");
  const std::string path = "/tmp/false_trips_" + std::to_string(::getpid()) + ".yaml";
  writeFileAtomically(path, text);
  return path;
}
double probe_period = 0.6;
bool watch_warnings = false;

/// A model file of robot and machine as they are; the residual that it promises is 1 N.
std::string trueModel(const mechanism::Robot& robot, const simulation::SimulationParameters& machine) {
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
  /// From where the robot stands to `pose` in `seconds`, rest to rest, at `speed` percent. False: refused, nothing moves.
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

/// A pose near home, the way to it slow or brisk.
mechanism::Pose somewhere(const mechanism::Pose& home, std::mt19937& random) {
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  mechanism::Pose pose = home;
  pose[0] += 0.02 * one(random);
  pose[1] += 0.04 * (1.0 + one(random));
  pose[2] += 0.06 * one(random);
  pose[3] += 0.06 * one(random);
  return pose;
}

/// Ordinary use for `hours`: paths, pauses, other speeds, rests of up to 20 s, now and then the drives off and on.
void use(const std::string& robot, const Machine& machine, double hours, unsigned seed,
         std::map<std::string, int>& trips) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  auto rig = std::make_unique<Rig>(robot, machine);
  double done_s = 0.0, began_s = rig->plant.time();
  while (done_s + rig->plant.time() - began_s < 3600.0 * hours) {
    ControlSystem& system = *rig->system;
    bool played = rig->hold() && rig->play(somewhere(rig->home, random), 2.0 + 10.0 * share(random));
    if (played && share(random) < 0.3) {
      system.run(share(random));
      system.pause();
      system.run(4.0 * share(random));
      system.setSpeed(20.0 + 80.0 * share(random));
      system.resume();
    }
    if (played && share(random) < 0.1) {
      system.run(share(random));
      system.stop();
    }
    system.waitFor(MachineState::Holding, 120.0);
    system.setSpeed(100.0);
    const double rest = share(random);  // now and then one that lasts
    system.run(rest < 0.01 ? 200.0 : rest < 0.2 ? 20.0 * share(random) : share(random));
    if (share(random) < 0.05) system.disable();
    const ControlStatus status = system.status();
    if (status.state == MachineState::Faulted || status.state == MachineState::SafeStopping) {
      ++trips[status.fault_name];
      std::printf("    %.0f s: %s\n", rig->plant.time(), status.fault_sentence.c_str());
      done_s += rig->plant.time() - began_s;
      for (const auto& [sentence, count] : rig->warnings)
        trips[sentence] += count;
      rig = std::make_unique<Rig>(robot, machine);
      began_s = rig->plant.time();
    }
  }
  for (const auto& [sentence, count] : rig->warnings)
    trips[sentence] += count;
}

int countTrips(const std::string& robot, double hours, unsigned seed) {
  int all = 0;
  std::printf("| machine %s | simulated h | stops of a healthy robot%s |\n| --- | --- | --- |\n", robot.c_str(),
              watch_warnings ? ", and warnings" : "");
  for (const Machine& machine : kMachines) {
    if (watch_warnings && &machine != kMachines) break;
    std::map<std::string, int> trips;
    use(robot, machine, hours, seed, trips);
    std::string text;
    for (const auto& [name, count] : trips) {
      text += (text.empty() ? "" : ", ") + name + " " + std::to_string(count);
      all += count;
    }
    std::printf("| %s | %.2f | %s |\n", machine.name, hours, text.empty() ? "0" : text.c_str());
    std::fflush(stdout);
  }
  return all;
}

/// Where the encoder dies.
enum class When { AtRest, AtRestThenPush, Moving, AtTheTurn, Swinging };

struct Outcome {
  std::string fault;
  double after_s = 0.0, sinks_m = 0.0;
};

Outcome freeze(const std::string& robot, const Machine& machine, std::size_t axis, When when, double push_N,
               double wait_s) {
  Rig rig(robot, machine);
  rig.hold();
  rig.system->run(2.5);
  if (when == When::Moving || when == When::AtTheTurn) {
    mechanism::Pose up = rig.home;
    up[1] += 0.06;
    rig.play(up, 4.0);
    rig.system->run(when == When::Moving ? 2.0 : 3.8 + 0.02 * wait_s);
    if (when == When::AtTheTurn) {
      rig.system->waitFor(MachineState::Holding, 10.0);
      rig.play(rig.home, 4.0);  // down again, and blind from its begin on
      rig.system->run(0.02 * wait_s);
    }
  }
  if (when == When::Swinging) {
    rig.swing();
    rig.system->run(wait_s);
  }
  const double height = rig.plant.state().pose[1], began = rig.plant.time();
  rig.lowest = height;
  rig.image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
  double planned = 0.0;
  if (when == When::AtRestThenPush) {
    rig.system->run(wait_s);
    rig.image.surroundings.pose_force[1].store(-push_N);
  }
  if (when == When::AtTheTurn) planned = -1.0;
  rig.system->waitFor(MachineState::Faulted, 6.0);
  Outcome outcome;
  outcome.fault = rig.system->status().fault_name;
  outcome.after_s = rig.plant.time() - began;
  // On the way down the platform sinks on purpose: what counts is how far it falls below the path.
  outcome.sinks_m = planned < 0.0 ? std::max(0.0, rig.home[1] - rig.lowest) : height - rig.lowest;
  return outcome;
}

int freezeAll(const std::string& robot) {
  struct Case {
    const char* what;
    When when;
    double push_N, wait_s;
  };
  const Case cases[] = {{"at rest, no push", When::AtRest, 0.0, 0.0},
                        {"at rest, 100 N after 2.5 s", When::AtRestThenPush, 100.0, 2.5},
                        {"at rest, 150 N after 2.5 s", When::AtRestThenPush, 150.0, 2.5},
                        {"at rest, 150 N at once", When::AtRestThenPush, 150.0, 0.0},
                        {"at rest, 150 N after 0.5 s", When::AtRestThenPush, 150.0, 0.5},
                        {"moving up, fast", When::Moving, 0.0, 0.0},
                        {"at the begin of the way down", When::AtTheTurn, 0.0, 0.0},
                        {"just after it", When::AtTheTurn, 0.0, 20.0},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 0.5},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 1.07},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 1.55},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 2.9},
                        {"anywhere on a path of turning points", When::Swinging, 0.0, 5.15}};
  int bad = 0, all = 0;
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> sinks_mm;
  std::map<std::string, int> names;
  std::printf(
      "| encoder dies (robot %s) | machine | axis | cause | after ms | sinks mm |\n| --- | --- | --- | --- | --- | --- "
      "|\n",
      robot.c_str());
  for (const Machine& machine : {kMachines[0], kMachines[1], kMachines[2]}) {
    for (const Case& one : cases) {
      for (std::size_t axis = 0; axis < mechanism::kLegs; ++axis) {
        const Outcome o = freeze(robot, machine, axis, one.when, one.push_N, one.wait_s);
        // Without a push nothing has to be found as long as nothing moves.
        const bool named = o.fault == "encoder_frozen" || (one.when == When::AtRest && o.fault.empty());
        const bool good = named && o.sinks_m < 0.005;
        ++all;
        bad += !good;
        if (sinks_mm.count(one.what) == 0) order.emplace_back(one.what);
        sinks_mm[one.what].push_back(1e3 * o.sinks_m);
        names[one.what] += o.fault == "encoder_frozen" ? 1 : 0;
        std::printf("| %s | %s | %zu | %s | %.0f | %s%.1f%s |\n", one.what, machine.name, axis + 1,
                    o.fault.empty() ? "none" : o.fault.c_str(), 1e3 * o.after_s, good ? "" : "**", 1e3 * o.sinks_m,
                    good ? "" : "**");
        std::fflush(stdout);
      }
    }
  }
  std::printf(
      "\n| encoder dies | runs | named `encoder_frozen` | sinks, median / largest mm | above 5 mm |\n| --- | --- | --- "
      "| "
      "--- | --- |\n");
  for (const std::string& what : order) {
    std::vector<double>& sinks = sinks_mm[what];
    std::sort(sinks.begin(), sinks.end());
    const auto above = std::count_if(sinks.begin(), sinks.end(), [](double mm) { return mm > 5.0; });
    std::printf("| %s | %zu | %d | %.1f / %.1f | %td |\n", what.c_str(), sinks.size(), names[what],
                sinks[sinks.size() / 2], sinks.back(), above);
  }
  std::printf("\n%d of %d with less than 5 mm, named encoder_frozen (or nothing moved and nobody pushed)\n", all - bad,
              all);
  return bad;
}

}  // namespace
}  // namespace knee_robot::control

int main(int argc, char** argv) {
  CLI::App app(
      "Stops of a healthy simulated robot in hours of ordinary use; with --frozen, what becomes of dead encoders.",
      "false_trips");
  std::string robot = "A";
  double hours = 0.25;
  unsigned seed = 1;
  bool frozen = false;
  app.add_option("--robot", robot, "of config/robots")->capture_default_str();
  app.add_option("--hours", hours, "simulated, of each machine")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 1000.0));
  app.add_option("--seed", seed)->capture_default_str();
  app.add_option("--probe-s", knee_robot::control::probe_period, "property of the Drivers; 0: no test pulses at all")
      ->capture_default_str();
  app.add_flag("--warnings", knee_robot::control::watch_warnings,
               "the first machine alone, with a model that is true: its stops and everything that is said");
  app.add_flag("--frozen", frozen, "encoders die at rest and in motion instead; slow");
  CLI11_PARSE(app, argc, argv);
  try {
    return (frozen ? knee_robot::control::freezeAll(robot) : knee_robot::control::countTrips(robot, hours, seed)) == 0
               ? 0
               : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "false_trips: %s\n", error.what());
    return 2;
  }
}
