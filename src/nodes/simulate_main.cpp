// simulate REFERENCE -o RECORDING: the whole controller on the simulated robot, stepped in one process: deterministic, and as
// fast as the machine is. What roslaunch simulation.launch does in real time.

#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/hardware/open_bus.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "program.h"

namespace {

using namespace knee_robot;

constexpr double kPlantStep = 0.001;  // s
constexpr double kPatience = 3600.0;  // s of simulated time for one movement

void require(const Answer& answer) {
  if (!answer.ok) throw InputError(answer.sentence);
  std::printf("%s\n", answer.sentence.c_str());
}

void requireHolding(ControlSystem& system) {
  if (system.waitFor(MachineState::Holding, kPatience)) return;
  const ControlStatus status = system.status();
  throw Refusal("the movement ended in " + std::string(toString(status.state)) + ": " + status.fault_sentence);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Plays a reference file through the whole controller on the simulated robot, in simulated time, and records it.",
      "simulate");
  std::string file, robot_file, simulation_file, hardware_file, deployment_file, output, space_name;
  app.add_option("FILE", file, "reference file")->required();
  app.add_option("--robot", robot_file, "robot file (YAML)")->required();
  app.add_option("--simulation", simulation_file, "simulation file: friction, brakes, payload (YAML)")->required();
  app.add_option("--hardware", hardware_file, "hardware file (YAML)")->required();
  app.add_option("--deployment", deployment_file, "deployment file (YAML)")->required();
  app.add_option("-o,--output", output, "recording to write (CSV); must not exist")->required();
  app.add_option("--space", space_name, "what the columns are, when the file's header does not say it")
      ->check(CLI::IsMember({"actuator", "platform", "relative"}));
  return runProgram(app, argc, argv, [&]() -> int {
    const Robot robot = loadRobot(robot_file);
    const HardwareFile hardware_description = loadHardwareFile(hardware_file);
    hardware::RobotImage image;
    RobotSimulation plant(robot, loadRobotInertia(robot), loadSimulationParameters(simulation_file), image);
    const std::unique_ptr<hardware::AxisBus> bus = hardware::openImageCards(image);

    ControlSystem::Options options;
    options.execution = rt::Execution::Stepped;
    ControlSystem system(robot, hardware_description, deployment_file, *bus, options);
    system.setPlant([&](rt::Nanoseconds time) {
      while (plant.time() + 0.5 * kPlantStep < 1e-9 * static_cast<double>(time))
        plant.step(kPlantStep);
    });
    require(system.start());
    require(system.loadReference(readReference(file, spaceNamed(space_name))));
    require(system.enable());
    require(system.approach());
    requireHolding(system);
    require(system.startRecording(output));
    require(system.play());
    requireHolding(system);
    require(system.stopRecording());
    require(system.shutdown());
    return kExitDone;
  });
}
