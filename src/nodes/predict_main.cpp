// predict: the forces that a model file predicts along recordings, beside the recorded ones.

#include <iostream>
#include <set>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/recording_units.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/predict_report.h"
#include "knee_robot/report/recorded_units.h"
#include "knee_robot/report/report_folder.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string robot, model, output;
  std::vector<std::string> recordings;
};

int run(const Arguments& a, const std::string& command_line) {
  report::Page("predict");  // what the report needs and is missing is said before the work
  mechanism::Robot robot = mechanism::loadAnyRobot(a.robot);
  report::requireReportFolder({"predict", a.output, {a.robot, robot.urdf, a.model}, a.recordings});
  const dynamics::Model model = dynamics::loadModel(a.model);
  std::vector<recording::Recording> recordings = identification::readRecordings(a.recordings);
  if (robot.axes() != model.axes) identification::adaptToRecordings(robot, recordings);
  identification::takeRecordedSteps(robot, recordings);
  identification::takeGains(model, robot);
  std::set<std::string> names;
  for (recording::Recording& r : recordings) {
    identification::toActuatorUnits(robot, r);
    if (!names.insert(r.name).second)
      throw InputError(r.path + ": another recording is named " + r.name + " too; rename one");
  }
  report::PredictResults results = report::predictRecordings(robot, model, a.model, recordings);
  results.command_line = command_line;
  report::toRecordedUnits(robot, results);
  report::writePredictFiles(results, a.output);
  std::cout << report::withUnits(results.units, report::predictSummary(results)) << "written: " << a.output
            << "/report.html, report.json and prediction_NAME.csv" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Predicts actuator forces along recordings by a model of identify or trace.", "predict");
  Arguments a;
  app.option("--robot", a.robot, "robot file").required();
  app.option("--model", a.model, "model.yaml of identify or trace").required();
  app.option("RECORDINGS", a.recordings, "recordings to predict").required();
  app.option("--output", a.output, "folder for report.html, report.json and prediction_NAME.csv").required();
  return nodes::runProgram(app, argc, argv, [&] { return run(a, nodes::commandLine("predict", argc, argv)); });
}
