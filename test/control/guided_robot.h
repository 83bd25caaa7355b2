// A simulated hand on the simulated robot A with the whole controller, stepped.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "knee_robot/simulation/simulated_hand.h"
#include "some_model.h"

namespace knee_robot::control::guided {

using mechanism::Pose;

inline std::string file(const std::string& name) {
  return std::string(KNEE_SOURCE_DIR) + "/" + name;
}
inline std::string temporary(const std::string& name) {
  return ::testing::TempDir() + std::to_string(::getpid()) + "_" + name;
}

struct Machine {
  double payload_kg = 0.0;
  bool model = true, brakes = true, enabling_switch = true;
  double coulomb_scale = 1.0;  // of the real friction, the model keeps what it knows
  bool played = false;         // two paths of all legs to and fro before it is guided
};

struct Rig {
  explicit Rig(const Machine& setup = {})
      : robot(mechanism::loadRobot(file("config/robots/A.yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot), parameters(setup), image),
        bus(simulation::openImageCards(image)),
        hand(image, {}),
        plays(setup.played) {
    ControlSystem::Options options;
    options.empty = true;
    options.execution = rt::Execution::Stepped;
    const std::string model = temporary("guide_model.yaml");
    dynamics::saveModel(fake::modelOf(robot, 150.0, 15.0, 60.0), model);
    if (setup.model) options.model = model;
    HardwareFile hardware = loadHardwareFile(file("config/hardware/simulated.yaml"));
    if (!setup.enabling_switch) hardware.enabling_switch_bit.reset();
    if (!setup.brakes) hardware.axes[2].hold_device = HoldDevice::ShortedWindings;
    system = std::make_unique<ControlSystem>(robot, hardware, file("config/deployment/simulation.yaml"), *bus, options);
    std::remove(model.c_str());
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time)) {
        if (wanted) pull();
        plant.step(0.001);
        look();
      }
    });
  }
  static simulation::SimulationParameters parameters(const Machine& setup) {
    simulation::SimulationParameters all = simulation::loadSimulationParameters(file("config/simulation/A.yaml"));
    if (setup.payload_kg > 0.0) all.payload = simulation::Payload{setup.payload_kg, {0.0, 0.0, 0.1}, 0.1};
    for (auto& axis : all.axes)
      axis.coulomb_N *= setup.coulomb_scale;
    return all;
  }
  void pull() {
    const double h = 1e-4, t = plant.time();
    hand.pull(plant.state(), wanted(t), (wanted(t + h) - wanted(t - h)) / (2.0 * h));
  }
  void look() {
    const mechanism::Vector4& v = plant.state().pose_velocity;
    fastest = std::max(fastest, v.head<2>().norm());
    farthest = std::max(farthest, (plant.state().pose - from).head<2>().norm());
    strongest = std::max(strongest, hand.force_N());
  }
  void watch() {
    from = plant.state().pose;
    fastest = farthest = strongest = 0.0;
  }
  void hold(bool switch_held) { image.surroundings.enabling_switch_held.store(switch_held ? 1 : 0); }
  /// A hand that leans on the platform by `distance` of its spring, begins to guide, and lets go when the axes have
  /// trembled.
  void beginLeaningOn(int coordinate, double distance) {
    ASSERT_TRUE(system->start().ok);
    ASSERT_TRUE(system->enable().ok);
    system->run(1.0);
    hold(true);
    Pose leans = plant.state().pose;
    leans[coordinate] += distance;
    wanted = [leans](double) { return leans; };
    system->run(0.3);
    ASSERT_TRUE(system->guide().ok);
    system->run(0.59);
    letGo();
    watch();
  }
  void begin(const std::string& patient = "") {
    ASSERT_TRUE(system->start().ok);
    if (!patient.empty()) {
      const Answer loaded = system->loadPatient(patient);
      ASSERT_TRUE(loaded.ok) << loaded.sentence;
    }
    ASSERT_TRUE(system->enable().ok);
    system->run(1.0);
    if (plays) {
      ASSERT_NO_FATAL_FAILURE(play());
    }
    hold(true);
    system->run(0.05);
    const Answer answer = system->guide();
    ASSERT_TRUE(answer.ok) << answer.sentence;
    ASSERT_EQ(system->state(), MachineState::Guiding);
    system->run(0.8);
    ASSERT_EQ(system->state(), MachineState::Guiding) << system->status().guiding;
    watch();
  }
  /// All legs to and fro in X, theta and psi, twice 12 s.
  void play() {
    const Pose home = plant.state().pose;
    trajectory::Reference reference;
    reference.name = "to_and_fro";
    reference.points.resize(2401, 4);
    const auto wave = [](int k, double period_s) { return 0.5 * (1.0 - std::cos(2.0 * M_PI * 0.01 * k / period_s)); };
    for (int k = 0; k <= 2400; ++k) {
      Pose pose = home;
      pose[0] += 0.07 * wave(k, 2.4);
      pose[2] += 0.09 * wave(k, 3.0);
      pose[3] += 0.10 * wave(k, 2.0);
      reference.points.row(k) = mechanism::legLengths(*robot.mechanism, pose).transpose();
    }
    reference.points.row(0) = mechanism::Lengths(system->snapshot()->reference_m.data()).transpose();
    const Answer loaded = system->loadReference(reference);
    ASSERT_TRUE(loaded.ok) << loaded.sentence;
    ASSERT_TRUE(system->play().ok);
    ASSERT_TRUE(system->waitFor(MachineState::Holding, 40.0)) << system->status().fault_sentence;
  }
  /// There and back by `distance` (coordinate 0: Xm, 1: Zm), at `speed` where it is fastest.
  void swing(int coordinate, double distance, double speed) {
    const double start = plant.time(), period = M_PI * std::abs(distance) / speed;
    const Pose home = plant.state().pose;
    wanted = [=](double t) {
      const double x = std::min(1.0, std::max(0.0, (t - start) / period));
      Pose pose = home;
      pose[coordinate] += 0.5 * distance * (1.0 - std::cos(2.0 * M_PI * x));
      return pose;
    };
  }
  void letGo() {
    wanted = nullptr;
    hand.letGo();
  }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  std::unique_ptr<hardware::AxisBus> bus;
  simulation::SimulatedHand hand;
  const bool plays;
  std::function<Pose(double)> wanted;
  Pose from = Pose::Zero();
  double fastest = 0.0, farthest = 0.0, strongest = 0.0;
  std::unique_ptr<ControlSystem> system;  // last: it goes on stepping the plant while it shuts down
};

}  // namespace knee_robot::control::guided
