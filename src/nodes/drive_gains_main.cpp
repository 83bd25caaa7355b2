// drive_gains: torque per ampere of a chain's drives from recordings without and with a payload of known mass.

#include <yaml-cpp/yaml.h>

#include <iostream>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/drive_gains.h"
#include "knee_robot/identification/recording_units.h"
#include "knee_robot/report/drive_gains_report.h"
#include "knee_robot/report/page.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string robot, output;
  std::vector<std::string> unloaded, loaded;
  double payload_kg = 0.0, cutoff_hz = 5.0;
};

std::vector<identification::Observation> observeAll(mechanism::Robot& robot, const std::vector<std::string>& files,
                                                    const identification::ObservationOptions& options) {
  const std::vector<recording::Recording> recordings = identification::loadRecordings(robot, files);
  return identification::observeAll(robot, identification::columnsOf(robot), recordings, options);
}

int run(const Arguments& a, const std::string& command_line) {
  report::Page("drive_gains");  // what the report needs and is missing is said before the work
  mechanism::Robot robot = mechanism::loadAnyRobot(a.robot);
  if (!robot.chain) throw InputError(a.robot + ": drive gains belong to `mechanism: chain`");
  std::vector<recording::Recording> read = identification::readRecordings(a.unloaded);
  identification::adaptToRecordings(robot, read);
  for (mechanism::Actuator& actuator : robot.actuators) {
    actuator.recorded = mechanism::Recorded::Current;
    actuator.torque_per_ampere = 0.0;  // found anew, whatever the file says
  }
  identification::ObservationOptions options;
  options.setCutoff(a.cutoff_hz);
  const std::vector<identification::Observation> unloaded = observeAll(robot, a.unloaded, options);
  const std::vector<identification::Observation> loaded = observeAll(robot, a.loaded, options);
  const identification::DriveGains gains = identification::driveGains(robot, unloaded, loaded, a.payload_kg, options);
  report::writeDriveGains(robot, gains, command_line, a.output);
  std::cout << report::driveGainsSummary(robot, gains) << "written: " << a.output
            << "/report.html, report.json, and robot.yaml with these gains" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app(
      "Torque per ampere of a chain's drives, from currents recorded without and with a payload of known mass.",
      "drive_gains");
  Arguments a;
  app.option("--robot", a.robot, "robot file (mechanism: chain)").required();
  app.option("--unloaded", a.unloaded, "recordings without the payload").required();
  app.option("--loaded", a.loaded, "recordings with the payload, fixed to the last link").required();
  app.option("--payload-kg", a.payload_kg, "mass of the payload, kg").required().within(1e-3, 1e4);
  app.option("--cutoff-hz", a.cutoff_hz, "cut-off of the zero-phase low-pass filter of regressor and current (5)")
      .within(1e-6, 1e6);
  app.option("--output", a.output, "folder for report.html, report.json and robot.yaml").required();
  return nodes::runProgram(app, argc, argv, [&] { return run(a, nodes::commandLine("drive_gains", argc, argv)); });
}
