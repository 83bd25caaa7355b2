// components: what the controller's component types say of themselves, as Markdown (docs/components.md holds a copy).

#include <cstdio>
#include <memory>

#include "knee_robot/base/errors.h"
#include "knee_robot/control/component_types.h"
#include "knee_robot/control/port_values.h"
#include "knee_robot/rt/component_page.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "program.h"

int main(int argc, char** argv) {
  using namespace knee_robot;
  nodes::CommandLine app(
      "Prints ports, properties and operations of every component type that a deployment file may name, and what the "
      "ports carry.",
      "components");
  std::string robot_file, hardware_file;
  app.option("--robot", robot_file, "robot file (YAML); defaults of properties may depend on it").required();
  app.option("--hardware", hardware_file, "hardware file (YAML)").required();
  return nodes::runProgram(app, argc, argv, [&] {
    const mechanism::Robot robot = mechanism::loadRobot(robot_file);
    const auto image = std::make_unique<simulation::RobotImage>();
    const auto bus = simulation::openImageCards(*image);
    const control::HardwareFile hardware = control::loadHardwareFile(hardware_file);
    std::printf("%s## Values of the ports\n\n%s",
                rt::componentPage(control::componentTypes(robot, hardware, *bus, {})).c_str(),
                control::portValuesTable().c_str());
    return kExitDone;
  });
}
