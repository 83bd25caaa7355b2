// compare: reference against measured, per actuator and in pose (the paper's Figs. 15 and 16).

#include <iostream>
#include <string>

#include "knee_robot/base/errors.h"
#include "knee_robot/report/compare.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/report_folder.h"
#include "program.h"

using namespace knee_robot;

namespace {

constexpr double kUsualConditionMax = 60.0;
constexpr double kWideOpen = 1e6;  // a margin at or beyond this says nothing about where errors grow

struct Arguments {
  std::string robot, recording, output;
  double condition_max = 0.0;
};

void declare(nodes::CommandLine& app, Arguments& a) {
  app.option("--robot", a.robot, "robot file").required();
  app.option("RECORDING", a.recording, "recording with reference columns; camera columns are used if there are any")
      .required();
  app.option("--output", a.output, "folder for report.html, report.json, actuators.svg and pose.svg").required();
  app.option("--condition-max", a.condition_max,
             "poses with a larger condition number of the Jacobian (m, rad) count as near a "
             "singularity (default: the robot file's margin, or 60 where that is wide open)")
      .within(1.0, 1e12);
}

int run(const Arguments& a, const std::string& command_line) {
  report::Page("compare");  // what the report needs and is missing is said before the work
  const mechanism::Robot robot = mechanism::loadRobot(a.robot);
  report::requireReportFolder({"compare", a.output, {a.robot, robot.urdf, a.recording}, {}});
  double condition_max = a.condition_max;
  if (condition_max == 0.0) {
    condition_max = robot.singularity_condition_max < kWideOpen ? robot.singularity_condition_max : kUsualConditionMax;
  }
  report::CompareResults results = report::compare(robot, recording::loadRecording(a.recording), condition_max);
  results.command_line = command_line;
  report::writeCompareFiles(results, a.output);
  std::cout << report::compareSummary(results) << "written: " << a.output
            << "/report.html, report.json, actuators.svg and pose.svg" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Compares reference and measured motion of a recording, per actuator and in pose.", "compare");
  Arguments arguments;
  declare(app, arguments);
  return nodes::runProgram(app, argc, argv, [&] { return run(arguments, nodes::commandLine("compare", argc, argv)); });
}
