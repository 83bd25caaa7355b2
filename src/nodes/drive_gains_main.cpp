// drive_gains: torque per ampere of a chain's drives from recordings without and with a payload of known mass.

#include <yaml-cpp/yaml.h>

#include <iostream>

#include "fit_recordings.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/identification/drive_gains.h"
#include "knee_robot/identification/recording_units.h"
#include "knee_robot/report/drive_gains_report.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/report_folder.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string robot, output;
  std::vector<std::string> unloaded, loaded;
  double payload_kg = 0.0, cutoff_hz = 5.0;
};

/// Recordings as they are, all with currents.
std::vector<recording::Recording> readCurrents(const std::vector<std::string>& files) {
  std::vector<recording::Recording> recordings = nodes::readAll(files);
  for (const recording::Recording& r : recordings) {
    if (r.current_A.cols() == 0)
      throw InputError(r.path + ":1: has no currents (columns current_1_A and on), from which drive gains are found");
  }
  return recordings;
}

/// The payload is what differs between the two: one file in both, under whatever name, would say that there is none.
void refuseSame(const std::vector<recording::Recording>& unloaded, const std::vector<recording::Recording>& loaded) {
  for (const recording::Recording& with : loaded) {
    for (const recording::Recording& without : unloaded) {
      if (with.fingerprint != without.fingerprint) continue;
      throw InputError(with.path + ": is also given as recorded without the payload" +
                       (with.path == without.path ? "" : " (as " + without.path + ")") +
                       "; a recording has the payload or not");
    }
  }
}

int run(const Arguments& a, const std::string& command_line) {
  report::Page("drive_gains");  // what the report needs and is missing is said before the work
  mechanism::Robot robot = mechanism::loadAnyRobot(a.robot);
  if (!robot.chain) throw InputError(a.robot + ": drive gains belong to `mechanism: chain`");
  std::vector<std::string> read = a.unloaded;
  read.insert(read.end(), a.loaded.begin(), a.loaded.end());
  read.insert(read.end(), {a.robot, robot.urdf});
  report::requireReportFolder({"drive_gains", a.output, read, {}});
  std::vector<recording::Recording> without = readCurrents(a.unloaded), with = readCurrents(a.loaded);
  refuseSame(without, with);
  nodes::requireFiltering(without, a.cutoff_hz);
  nodes::requireFiltering(with, a.cutoff_hz);
  identification::adaptToRecordings(robot, without);
  for (mechanism::Actuator& actuator : robot.actuators) {
    actuator.recorded = mechanism::Recorded::Current;
    actuator.torque_per_ampere = 0.0;  // found anew, whatever the file says
  }
  identification::ObservationOptions options;
  options.setCutoff(a.cutoff_hz);
  const std::vector<recording::Recording> light = nodes::inUnits(robot, without), heavy = nodes::inUnits(robot, with);
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  const std::vector<identification::Observation> unloaded = identification::observeAll(robot, columns, light, options),
                                                 loaded = identification::observeAll(robot, columns, heavy, options);
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
