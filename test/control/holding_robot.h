// The whole controller on the simulated robot A, or another, stepped, holding; with a model of it or without.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <set>

#include "knee_robot/control/control_system.h"
#include "knee_robot/control/disturbance_sentences.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "some_model.h"

namespace knee_robot::control::holding {

inline std::string file(const std::string& name) {
  return std::string(KNEE_SOURCE_DIR) + "/" + name;
}

struct Truth {
  bool model = false;  // the controller has one of 150 N s/m, 15 N (leg 4: 60 N)
  double payload_kg = 0.0;
  double friction_3 = 1.0;              // times what the model knows
  bool ready_line = false;              // the drives' ready outputs are wired
  double coulomb_4_N = 0.0;             // instead of the simulation file's
  bool carried = false;                 // by a crane: nothing weighs
  std::uint8_t dead = 0, reversed = 0;  // masks of drives, from the start on
  std::uint8_t blind = 0;               // of encoders
  double weights = 1.0;                 // of the model's links, times the true ones
  const char* deployment = "config/deployment/simulation.yaml";
  std::string robot = "A";
  std::string patient{};  // file; empty: nobody is on the robot
  double stands_s = 3.0;  // after it was enabled: every encoder has been asked once
  double share_gravity = 1.0;
};

inline simulation::SimulationParameters parameters(const Truth& truth) {
  simulation::SimulationParameters all =
      simulation::loadSimulationParameters(file("config/simulation/" + truth.robot + ".yaml"));
  if (truth.payload_kg > 0.0) all.payload = simulation::Payload{truth.payload_kg, {0.0, 0.0, 0.05}, 0.1};
  for (auto& axis : all.axes)
    axis.viscous_N_s_per_m = 150.0;
  all.axes[2].viscous_N_s_per_m *= truth.friction_3;
  all.axes[2].coulomb_N *= truth.friction_3;
  if (truth.coulomb_4_N > 0.0) all.axes[3].coulomb_N = truth.coulomb_4_N;
  return all;
}

inline mechanism::Robot carriedByCrane(mechanism::Robot robot) {
  robot.gravity.setZero();
  return robot;
}

struct HoldingRobot {
  explicit HoldingRobot(const Truth& truth = {})
      : robot(mechanism::loadRobot(file("config/robots/" + truth.robot + ".yaml"))),
        plant(truth.carried ? carriedByCrane(robot) : robot, dynamics::loadRobotInertia(robot), parameters(truth),
              image),
        bus(simulation::openImageCards(image)) {
    ControlSystem::Options options;
    options.empty = true;
    options.execution = rt::Execution::Stepped;
    const std::string path = ::testing::TempDir() + "disturbance_" + std::to_string(::getpid()) + ".yaml";
    if (truth.model) {
      dynamics::Model model = fake::modelOf(robot, 150.0, 15.0, 60.0);
      for (std::size_t i = 0; i < 4; ++i)
        model.parameters[dynamics::extended::kRotor + i].value = 5.6;
      for (std::size_t i = 0; i < dynamics::kInertialParameters; ++i)
        model.parameters[i].value *= truth.weights;
      dynamics::saveModel(model, path);
      options.model = path;
    }
    HardwareFile hardware = loadHardwareFile(file("config/hardware/simulated.yaml"));
    if (truth.ready_line) hardware.drives_ready_bit = 2;
    system = std::make_unique<ControlSystem>(robot, hardware, file(truth.deployment), *bus, options);
    std::remove(path.c_str());
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time))
        plant.step(0.001);
      lowest = std::min(lowest, plant.state().pose[1]);
    });
    image.faults.drive_dead.store(truth.dead);
    image.faults.drive_reversed.store(truth.reversed);
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      if ((truth.blind >> i & 1u) != 0) freeze(i);
    }
    stood = lowest = plant.state().pose[1];
    EXPECT_TRUE(system->start().ok);
    if (!truth.patient.empty()) {
      EXPECT_TRUE(system->loadPatient(truth.patient).ok);
    }
    if (truth.share_gravity != 1.0) {
      EXPECT_TRUE(system->setProperty("Feedforward", "share_gravity", std::to_string(truth.share_gravity)).ok);
    }
    EXPECT_TRUE(system->enable().ok);
    system->run(truth.stands_s);
  }
  void freeze(std::size_t axis) {
    image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
  }
  /// Up and down by 60 mm, four times, in 8 s each.
  void play(int points = 800) {
    trajectory::Reference reference;
    reference.name = "up_and_down";
    const mechanism::Pose home = plant.state().pose;
    reference.points.resize(4 * points + 1, 4);
    for (int k = 0; k <= 4 * points; ++k) {
      mechanism::Pose pose = home;
      pose[1] += 0.03 * (1.0 - std::cos(2.0 * M_PI * k / points));
      reference.points.row(k) = mechanism::legLengths(*robot.mechanism, pose).transpose();
    }
    // The first point is where the Drivers hold, not where the axes stick.
    reference.points.row(0) = reference.points.row(4 * points);
    ASSERT_TRUE(system->loadReference(reference).ok);
    ASSERT_TRUE(system->play().ok);
  }
  /// All legs to and fro within 12 s, 80 mm in X, 0.1 rad in theta and psi with periods of their own, height constant.
  void swing() {
    const mechanism::Pose home = plant.state().pose;
    const mechanism::Lengths stands(system->snapshot()->reference_m.data());
    const mechanism::Lengths beside = stands - mechanism::legLengths(*robot.mechanism, home);
    trajectory::Reference reference;
    reference.name = "swing";
    reference.points.resize(1201, 4);
    const auto wave = [](int k, double period_s) { return 0.5 * (1.0 - std::cos(2.0 * M_PI * 0.01 * k / period_s)); };
    for (int k = 0; k <= 1200; ++k) {
      mechanism::Pose pose = home;
      pose[0] += 0.08 * wave(k, 2.4);
      pose[2] += 0.10 * wave(k, 3.0);
      pose[3] += 0.12 * wave(k, 2.0);
      reference.points.row(k) = (mechanism::legLengths(*robot.mechanism, pose) + beside).transpose();
    }
    const Answer loaded = system->loadReference(reference);
    ASSERT_TRUE(loaded.ok) << loaded.sentence;
    ASSERT_TRUE(system->play().ok);
  }
  /// Everything that was said within `seconds`, each sentence without its numbers once.
  std::set<std::string> said(double seconds) {
    std::set<std::string> all;
    for (int k = 0; k < static_cast<int>(1000 * seconds); ++k) {
      system->step();
      const std::optional<Disturbance> now = system->disturbance();
      if (!now) continue;
      for (const Notice& notice : noticesOf(*now)) {
        last = notice.sentence;
        all.insert(notice.sentence.substr(0, notice.sentence.find(" about ")));
      }
    }
    return all;
  }
  void push(double newton) { image.surroundings.pose_force[1].store(-newton); }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  std::unique_ptr<hardware::AxisBus> bus;
  double lowest = 10.0, stood = 0.0;  // m; before it was enabled
  std::string last;
  std::unique_ptr<ControlSystem> system;  // last: it goes on stepping the plant while it shuts down
};

}  // namespace knee_robot::control::holding
