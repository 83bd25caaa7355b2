// simulate_guiding: a simulated hand guides the simulated robot; what force it needs at the handle, without and with
// the controller's help.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "knee_robot/simulation/simulated_hand.h"
#include "program.h"

namespace {

using namespace knee_robot;

constexpr double kStep = 0.001;  // s
constexpr const char* kNames[] = {"sideways (Xm)", "upwards (Zm)", "tilting (theta)", "turning (psi)"};
constexpr double kLever_m = 0.2;

struct Options {
  std::string robot, simulation, hardware, deployment, model;
  double distance_m = 0.03, speed_m_per_s = 0.02;
};

struct Felt {
  double mean_N = 0.0, peak_N = 0.0, reached = 0.0;  // reached: share of the way
};

/// There and back along one coordinate; angles by the lever.
class Pull {
 public:
  Pull(const simulation::RobotSimulation& plant, simulation::SimulatedHand& hand, int coordinate,
       const Options& options)
      : plant_(plant),
        hand_(hand),
        home_(plant.state().pose),
        start_(plant.time()),
        coordinate_(coordinate),
        distance_(coordinate < 2 ? options.distance_m : options.distance_m / kLever_m),
        period_(2.0 * options.distance_m / options.speed_m_per_s) {}
  double period() const { return period_; }
  void step() {
    const double h = 1e-4, t = plant_.time();
    hand_.pull(plant_.state(), at(t), (at(t + h) - at(t - h)) / (2.0 * h));
    sum_ += hand_.force_N();
    ++count_;
    felt_.peak_N = std::max(felt_.peak_N, hand_.force_N());
    felt_.reached = std::max(felt_.reached, (plant_.state().pose[coordinate_] - home_[coordinate_]) / distance_);
  }
  Felt felt() const {
    Felt all = felt_;
    all.mean_N = count_ > 0.0 ? sum_ / count_ : 0.0;
    return all;
  }

 private:
  mechanism::Pose at(double t) const {
    const double x = std::min(1.0, std::max(0.0, (t - start_) / period_));
    mechanism::Pose pose = home_;
    pose[coordinate_] += distance_ * 0.5 * (1.0 - std::cos(kTwoPi * x));
    return pose;
  }
  const simulation::RobotSimulation& plant_;
  simulation::SimulatedHand& hand_;
  const mechanism::Pose home_;
  const double start_;
  const int coordinate_;
  const double distance_, period_;
  Felt felt_;
  double sum_ = 0.0, count_ = 0.0;
};

/// A hand of 600 N: stronger than any, so that the force is the robot's.
simulation::SimulatedHand::Impedance hand() {
  simulation::SimulatedHand::Impedance one;
  one.stiffness_N_per_m = 20000.0;
  one.damping_N_s_per_m = 400.0;
  one.largest_N = 600.0;
  one.lever_m = kLever_m;
  return one;
}

void require(const control::Answer& answer) {
  if (!answer.ok) throw Refusal(answer.sentence);
}

/// Drives off, brakes opened by hand; somebody else bears the weight while the hand is only asked for what moves the
/// platform.
Felt pullUnpowered(const Options& options, int coordinate) {
  const mechanism::Robot robot = mechanism::loadRobot(options.robot);
  simulation::RobotImage image;
  simulation::RobotSimulation plant(robot, dynamics::loadRobotInertia(robot),
                                    simulation::loadSimulationParameters(options.simulation), image);
  image.faults.hold_open.store(15);
  simulation::SimulatedHand one(image, hand());
  Pull pull(plant, one, coordinate, options);
  for (double t = 0.0; t < pull.period(); t += kStep) {
    pull.step();
    plant.step(kStep);
  }
  return pull.felt();
}

struct Rig {
  explicit Rig(const Options& options)
      : robot(mechanism::loadRobot(options.robot)),
        plant(robot, dynamics::loadRobotInertia(robot), simulation::loadSimulationParameters(options.simulation),
              image),
        bus(simulation::openImageCards(image)),
        one(image, hand()),
        system(robot, control::loadHardwareFile(options.hardware), options.deployment, *bus, settings(options)) {
    system.setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.5 * kStep < 1e-9 * static_cast<double>(time)) {
        if (pull) pull->step();
        plant.step(kStep);
      }
    });
    require(system.start());
    require(system.enable());
    system.run(1.0);
  }
  static control::ControlSystem::Options settings(const Options& options) {
    control::ControlSystem::Options all;
    all.execution = rt::Execution::Stepped;
    all.empty = true;
    all.model = options.model;
    return all;
  }
  void guide() {
    image.surroundings.enabling_switch_held.store(1);
    system.run(0.05);
    require(system.guide());
    system.run(0.8);
  }
  Felt feel(int coordinate, const Options& options) {
    pull.emplace(plant, one, coordinate, options);
    system.run(pull->period());
    return pull->felt();
  }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  std::unique_ptr<hardware::AxisBus> bus;
  simulation::SimulatedHand one;
  std::optional<Pull> pull;
  control::ControlSystem system;  // last: it goes on stepping the plant while it shuts down
};

void print(const char* name, const char* what, const Felt& felt, const std::string& ended) {
  std::printf("| %s | %s | %.0f | %.0f | %.0f | %s |\n", name, what, felt.mean_N, felt.peak_N, 100.0 * felt.reached,
              ended.c_str());
  std::fflush(stdout);
}

std::string endOf(control::ControlSystem& system) {
  const control::ControlStatus status = system.status();
  if (!status.fault_name.empty()) return status.fault_name;
  return status.guiding.empty() ? std::string("-") : status.guiding;
}

void printDirection(const Options& options, int coordinate) {
  const char* name = kNames[coordinate];
  print(name, "drives off, brakes opened by hand", pullUnpowered(options, coordinate), "-");
  {
    Rig rig(options);
    print(name, "the controller holds", rig.feel(coordinate, options), endOf(rig.system));
  }
  {
    Rig rig(options);
    require(rig.system.setProperty("Guide", "share_friction", "0"));
    rig.guide();
    print(name, "guided, weight carried only", rig.feel(coordinate, options), endOf(rig.system));
  }
  Rig rig(options);
  rig.guide();
  print(name, "guided, weight and friction carried", rig.feel(coordinate, options), endOf(rig.system));
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app(
      "A simulated hand moves the simulated robot there and back. Prints the force that it needs at the platform's "
      "origin with the drives off, while the robot holds, and while it is guided. Moments count at a lever of 0.2 m.",
      "simulate_guiding");
  Options options;
  app.option("--robot", options.robot, "robot file (YAML)").required();
  app.option("--simulation", options.simulation, "simulation file (YAML)").required();
  app.option("--hardware", options.hardware, "hardware file (YAML)").required();
  app.option("--deployment", options.deployment, "deployment file (YAML) with a HandGuide").required();
  app.option("--model", options.model, "model file of identify or trace").required();
  app.option("--distance", options.distance_m, "distance of the guided movement, m").within(0.005, 0.2);
  app.option("--speed", options.speed_m_per_s, "mean speed of the hand, m/s").within(0.001, 0.05);
  return nodes::runProgram(app, argc, argv, [&]() -> int {
    std::printf("| direction | how | force, mean N | force, peak N | %% of the way | ended by |\n");
    std::printf("| --- | --- | --- | --- | --- | --- |\n");
    for (int coordinate = 0; coordinate < 4; ++coordinate)
      printDirection(options, coordinate);
    return kExitDone;
  });
}
