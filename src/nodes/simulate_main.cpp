// simulate REFERENCE -o RECORDING: the whole controller on the simulated robot, stepped in one process: deterministic,
// and as fast as the machine is. What roslaunch simulation.launch does in real time.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/output_paths.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "pauses.h"
#include "program.h"

namespace {

using namespace knee_robot;

constexpr double kPlantStep = 0.001;  // s
constexpr double kPatience = 3600.0;  // s of simulated time for one movement
constexpr double kSagTime = 2.0;      // s after the take-over in which the platform may still sag

/// How far the axes are from where they should be.
class Deviation {
 public:
  void add(const mechanism::Vector4& error, const mechanism::Vector4& velocity) {
    square_ += error.cwiseAbs2();
    peak_ = peak_.cwiseMax(error.cwiseAbs());
    fastest_ = fastest_.cwiseMax(velocity.cwiseAbs());
    ++count_;
  }
  /// Legs 1 to 4, each in thousandths.
  void print(const char* what, const char* unit) const {
    if (count_ == 0) return;
    const auto line = [&](const char* kind, const mechanism::Vector4& v) {
      std::printf("%s, %s %s: %.3f %.3f %.3f %.3f\n", what, kind, unit, 1e3 * v[0], 1e3 * v[1], 1e3 * v[2], 1e3 * v[3]);
    };
    line("rms", (square_ / count_).cwiseSqrt());
    line("peak", peak_);
  }
  void printSpeed(const char* what) const {
    std::printf("%s, fastest mm/s: %.2f %.2f %.2f %.2f\n", what, 1e3 * fastest_[0], 1e3 * fastest_[1],
                1e3 * fastest_[2], 1e3 * fastest_[3]);
  }

 private:
  mechanism::Vector4 square_ = mechanism::Vector4::Zero(), peak_ = mechanism::Vector4::Zero(),
                     fastest_ = mechanism::Vector4::Zero();
  double count_ = 0.0;
};

/// Looks at every cycle of the plant and of the controller; tells what the controller's own recording does not: where
/// the robot really was while the Drivers took over.
class Watch {
 public:
  enum class What { Nothing, TakeOver, Play };
  Watch(const simulation::RobotSimulation& plant, const control::ControlSystem& system, const mechanism::Robot& robot)
      : plant_(plant), system_(system) {
    for (Eigen::Index i = 0; i < limit_N_.size(); ++i)
      limit_N_[i] = robot.actuators[static_cast<std::size_t>(i)].forceLimit();
  }
  void begin(What what) {
    what_ = what;
    stood_ = plant_.lengths();
    height_ = plant_.state().pose[1];
  }
  void sample() {
    if (what_ == What::Nothing) return;
    const std::optional<control::TrackingRow> row = system_.snapshot();
    if (!row) return;
    const mechanism::Vector4 velocity(row->velocity_m_per_s.data());
    if (what_ == What::TakeOver) take_over_.add(plant_.lengths() - stood_, velocity);
    if (what_ == What::TakeOver) sag_ = std::max(sag_, height_ - plant_.state().pose[1]);
    if (what_ != What::Play) return;
    play_.add(mechanism::Vector4(row->reference_m.data()) - mechanism::Vector4(row->position_m.data()), velocity);
    left_.add(1e-3 * (mechanism::Vector4(row->force_N.data()) - mechanism::Vector4(row->feedforward_N.data())),
              mechanism::Vector4::Zero());
    const mechanism::Vector4 force(row->force_N.data());
    force_.add(1e-3 * force, mechanism::Vector4::Zero());
    if (cycles_ > 0) jitter_.add(1e-3 * (force - last_force_N_), mechanism::Vector4::Zero());
    last_force_N_ = force;
    for (Eigen::Index i = 0; i < force.size(); ++i)
      clamped_[i] += std::abs(force[i]) >= 0.999 * limit_N_[i] ? 1.0 : 0.0;
    ++cycles_;
  }
  void printTakeOver() const {
    take_over_.print("take-over, axes move by", "mm");
    take_over_.printSpeed("take-over");
    std::printf("take-over, platform sinks by mm: %.3f\n", 1e3 * sag_);
  }
  void printPlay() const {
    play_.print("playing, error", "mm");
    play_.printSpeed("playing");
    left_.print("playing, force left to the loops", "N");
    force_.print("playing, force", "N");
    jitter_.print("playing, change of force from cycle to cycle", "N");
    if (cycles_ == 0) return;
    const mechanism::Vector4 share = clamped_ / cycles_;
    std::printf("playing, share of the time at the force limit: %.4f %.4f %.4f %.4f\n", share[0], share[1], share[2],
                share[3]);
  }

 private:
  const simulation::RobotSimulation& plant_;
  const control::ControlSystem& system_;
  What what_ = What::Nothing;
  mechanism::Vector4 stood_ = mechanism::Vector4::Zero();
  double height_ = 0.0, sag_ = 0.0;
  Deviation take_over_, play_, left_, force_, jitter_;
  mechanism::Vector4 limit_N_ = mechanism::Vector4::Zero(), last_force_N_ = mechanism::Vector4::Zero(),
                     clamped_ = mechanism::Vector4::Zero();
  double cycles_ = 0.0;
};

/// What the controller's sentences on drives, encoders and references do not think of: they are sure here, and a model
/// that was given need not be possible. Empty where it is no cause.
std::string aboutModel(const control::ControlSystem& system, const control::ControlStatus& status) {
  const std::set<std::string> by_force = {"runaway",        "following_error", "acceleration_limit",
                                          "velocity_limit", "stalled",         "saturated"};
  const std::string feedforward = system.feedforward();
  if (by_force.count(status.fault_name) == 0 || feedforward.rfind("the model ", 0) != 0) return "";
  return "; or the feedforward pushes it: " + feedforward + " asks for forces that are not those of this robot";
}

void require(const control::Answer& answer) {
  if (!answer.ok) throw InputError(answer.sentence);
  std::printf("%s\n", answer.sentence.c_str());
}

/// As above; a fault that came in between is named as the controller's event log does.
void require(const control::ControlSystem& system, const control::Answer& answer) {
  const control::ControlStatus status = system.status();
  if (!answer.ok && !status.fault_name.empty()) {
    std::printf("fault: %s: %s\n", status.fault_name.c_str(), status.fault_sentence.c_str());
    throw InputError(answer.sentence + aboutModel(system, status));
  }
  require(answer);
}

void set(control::ControlSystem& system, const std::string& setting) {
  const std::size_t dot = setting.find('.'), equals = setting.find('=');
  if (dot == std::string::npos || equals == std::string::npos || equals < dot)
    throw InputError("--set " + setting + ": give COMPONENT.PROPERTY=VALUE, as Feedforward.share_friction=0.5");
  require(system.setProperty(setting.substr(0, dot), setting.substr(dot + 1, equals - dot - 1),
                             setting.substr(equals + 1)));
}

/// Table of the force that all simulated effects exert, while the movement is recorded. An empty path: none.
class Truth {
 public:
  explicit Truth(const std::string& path) : path_(path) {}
  void record(bool on) { recording_ = on && !path_.empty(); }
  void add(double time_s, const mechanism::Vector4& effects_N) {
    if (!recording_) return;
    char row[128];
    std::snprintf(row, sizeof row, "%.6f,%.6g,%.6g,%.6g,%.6g\n", time_s, effects_N[0], effects_N[1], effects_N[2],
                  effects_N[3]);
    table_ += row;
  }
  void write() const {
    if (!path_.empty()) writeFileAtomically(path_, table_);
  }

 private:
  std::string path_, table_ = "time_s,effect_1_N,effect_2_N,effect_3_N,effect_4_N\n";
  bool recording_ = false;
};

void requireHolding(control::ControlSystem& system) {
  if (system.waitFor(control::MachineState::Holding, kPatience)) return;
  const control::ControlStatus status = system.status();
  std::printf("fault: %s: %s\n", status.fault_name.c_str(), status.fault_sentence.c_str());
  throw Refusal("the movement ended in " + std::string(control::toString(status.state)) + ": " + status.fault_sentence +
                aboutModel(system, status));
}

struct Arguments {
  std::string file, robot, simulation, hardware, deployment, output, truth, space, model;
  std::optional<double> payload_kg;
  std::vector<std::string> settings;
  nodes::Pauses::Options pauses;
};

void declare(nodes::CommandLine& app, Arguments& a) {
  app.option("FILE", a.file, "reference file").required();
  app.option("--robot", a.robot, "robot file (YAML)").required();
  app.option("--simulation", a.simulation, "simulation file: friction, brakes, payload (YAML)").required();
  app.option("--hardware", a.hardware, "hardware file (YAML)").required();
  app.option("--deployment", a.deployment, "deployment file (YAML)").required();
  app.option("-o,--output", a.output, "recording to write (CSV); must not exist").required();
  app.option("--truth", a.truth,
             "table (CSV) to write; must not exist: force of all simulated effects per actuator and row, N, to compare "
             "with what trace finds");
  app.option("--space", a.space, "what the columns are, when the file's header does not say it")
      .oneOf({"actuator", "platform", "relative"});
  app.option("--model", a.model, "model file for the feedforward; default: the deployment's");
  app.option("--payload-kg", a.payload_kg, "payload that the feedforward assumes, kg");
  app.option("--set", a.settings,
             "COMPONENT.PROPERTY=VALUE, may be repeated: sets a property that may change at run time");
  app.option("--pauses-per-minute", a.pauses.per_minute,
             "random pauses of the controller's computer per minute while playing (no cycles, no rows)")
      .within(0.0, 600.0);
  app.option("--longest-pause-s", a.pauses.longest_s, "pauses last between 1 ms and this long")
      .within(0.001, 1.0)
      .showDefault();
  app.option("--seed", a.pauses.seed, "random seed of the pauses").showDefault();
}

control::ControlSystem::Options optionsOf(const Arguments& a, const mechanism::Lengths& start) {
  control::ControlSystem::Options options;
  options.execution = rt::Execution::Stepped;
  options.empty = true;
  options.lengths_at_start_m = control::AxisValues{start[0], start[1], start[2], start[3]};
  options.model = a.model;
  options.payload_kg = a.payload_kg;
  return options;
}

void takeOver(control::ControlSystem& system, Watch& watch) {
  watch.begin(Watch::What::TakeOver);
  require(system, system.enable());
  system.run(kSagTime);
  watch.begin(Watch::What::Nothing);
  watch.printTakeOver();
}

void playAndRecord(control::ControlSystem& system, const Arguments& a, Watch& watch, Truth& truth) {
  require(system, system.approach());
  requireHolding(system);
  require(system.startRecording(a.output));
  watch.begin(Watch::What::Play);
  truth.record(true);
  require(system, system.play());
  nodes::Pauses machine(a.pauses);
  machine.waitWhileBusy(system, kPatience);
  requireHolding(system);
  machine.print();
  watch.printPlay();
  require(system.stopRecording());
  truth.record(false);
}

/// Whether both tables have a place is asked before the work.
void requireOutput(const Arguments& a) {
  requireNew(a.output);
  if (a.truth.empty()) return;
  requireNew(a.truth);
  if (isSameFile(a.truth, a.output))
    throw InputError("--truth " + a.truth + ": is the recording's name, too; choose another one");
}

int run(const Arguments& a) {
  requireOutput(a);
  const mechanism::Robot robot = mechanism::loadRobot(a.robot);
  const control::HardwareFile hardware_description = control::loadHardwareFile(a.hardware);
  simulation::RobotImage image;
  simulation::RobotSimulation plant(robot, dynamics::loadRobotInertia(robot),
                                    simulation::loadSimulationParameters(a.simulation), image);
  const std::unique_ptr<hardware::AxisBus> bus = simulation::openImageCards(image);
  Truth truth(a.truth);
  std::optional<Watch> watching;
  control::ControlSystem system(robot, hardware_description, a.deployment, *bus, optionsOf(a, plant.lengths()));
  // What it steps stays behind it: it goes on stepping while it shuts down.
  Watch& watch = watching.emplace(plant, system, robot);
  system.setPlant([&](rt::Nanoseconds time) {
    while (plant.time() + 0.5 * kPlantStep < 1e-9 * static_cast<double>(time)) {
      const double began = plant.time();
      plant.step(kPlantStep);
      truth.add(began, plant.unmodelled());
    }
    watch.sample();
  });
  std::printf("feedforward: %s\n", system.feedforward().c_str());
  require(system.start());
  for (const std::string& setting : a.settings)
    set(system, setting);
  require(system.loadReference(trajectory::readReference(a.file, trajectory::spaceNamed(a.space))));
  takeOver(system, watch);
  playAndRecord(system, a, watch, truth);
  truth.write();
  require(system, system.shutdown());
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app(
      "Plays a reference file through the whole controller on the simulated robot, in simulated time, and records it.",
      "simulate");
  Arguments a;
  declare(app, a);
  return nodes::runProgram(app, argc, argv, [&] { return run(a); });
}
