// The true robot A under a controller that was given other files of it.
#pragma once

#include "holding_robot.h"
#include "knee_robot/base/errors.h"

namespace knee_robot::control::mistaken {

struct Files {
  std::string robot = holding::file("config/robots/A.yaml");
  std::string hardware = holding::file("config/hardware/simulated.yaml");
  std::string deployment = holding::file("config/deployment/simulation.yaml");
};

struct Outcome {
  std::string refusal;   // of the files
  double leg_m = 0.0;    // the farthest that a leg goes
  double first_m = 0.0;  // the same before anything was to move
  bool ends_off = true;  // drives and brakes, in the end
  std::string fault{};   // the first, and when it was found
};

/// A path of 10 mm of each leg, up and down again, from where they are held.
inline void lifts(ControlSystem& system) {
  trajectory::Reference reference;
  reference.name = "lift";
  const mechanism::Lengths stands(system.snapshot()->reference_m.data());
  reference.points.resize(201, 4);
  for (int k = 0; k <= 200; ++k)
    reference.points.row(k) = stands.transpose().array() + 0.005 * (1.0 - std::cos(2.0 * M_PI * k / 200));
  try {
    if (system.loadReference(reference).ok) system.play();
  } catch (const InputError&) {
    // The absurd limits do not allow it.
  }
}

/// The true robot A under a controller with these files: enabled, lifted, held, disabled.
inline Outcome outcomeOf(const Files& files) {
  Outcome outcome;
  simulation::RobotImage image;
  const mechanism::Robot truth = mechanism::loadRobot(Files().robot);
  simulation::RobotSimulation plant(truth, dynamics::loadRobotInertia(truth),
                                    simulation::loadSimulationParameters(holding::file("config/simulation/A.yaml")),
                                    image);
  const std::unique_ptr<hardware::AxisBus> bus = simulation::openImageCards(image);
  const mechanism::Lengths home = plant.lengths();
  ControlSystem::Options options;
  options.empty = true;
  options.execution = rt::Execution::Stepped;
  std::unique_ptr<ControlSystem> system;
  try {
    system = std::make_unique<ControlSystem>(mechanism::loadRobot(files.robot), loadHardwareFile(files.hardware),
                                             files.deployment, *bus, options);
  } catch (const InputError& error) {
    outcome.refusal = error.what();
    return outcome;
  }
  system->setPlant([&](rt::Nanoseconds time) {
    while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time)) {
      plant.step(0.001);
      outcome.leg_m = std::max(outcome.leg_m, (plant.lengths() - home).cwiseAbs().maxCoeff());
    }
  });
  if (system->start().ok && system->enable().ok) {
    system->run(1.5);
    outcome.first_m = outcome.leg_m;
    const bool held = system->state() == MachineState::Holding;
    lifts(*system);
    system->run(2.5);
    outcome.fault = system->status().fault_name + (held ? "" : " at enabling");
    system->disable();
  } else {
    outcome.first_m = outcome.leg_m;
    outcome.fault = system->status().fault_name + " at enabling";
  }
  system->run(0.5);
  outcome.ends_off = (image.counter.outputs.load() & 3) == 0;
  return outcome;
}

}  // namespace knee_robot::control::mistaken
