// identify: force model of a robot from recordings.

#include <algorithm>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/report/identify_report.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string robot, output;
  std::vector<std::string> train, validate;
  double cutoff_hz = 3.0;
  IdentifyOptions options;
};

void declare(CLI::App& app, Arguments& a) {
  const auto positive = CLI::Range(1e-6, 1e6);
  app.add_option("--robot", a.robot, "robot file")->required();
  app.add_option("--train", a.train, "recordings that the model is fitted to")->required();
  app.add_option("--validate", a.validate, "recordings that judge the finished model");
  app.add_option("--output", a.output, "folder for model.yaml, report.json, report.html and predictions")->required();
  app.add_option("--cutoff-hz", a.cutoff_hz, "zero-phase low-pass of both sides of the equation (3)")->check(positive);
  app.add_option("--rate-hz", a.options.observation.signals.rate_hz,
                 "samples a second at most (100); a finer grid meets reversals of friction more exactly")
      ->check(CLI::Range(1.0, 1e4));
  app.add_option("--moving-m-per-s", a.options.observation.moving_m_per_s,
                 "slower axes do not count as moving (0.0015)")
      ->check(CLI::Range(0.0, 10.0));
  app.add_option("--condition-max", a.options.observation.condition_max,
                 "poses with a worse condition of the Jacobian (m, rad) are masked (the robot file's margin, 60 if "
                 "that is wide open)")
      ->check(CLI::Range(1.0, 1e12));
  app.add_flag(
      "--joint-friction", a.options.joint_friction,
      "friction of the legs' passive joints too, as in the paper's eq. (22); needs a motion that tells it from "
      "the actuators'");
  app.add_option(
         "--narrowest-counts", a.options.narrowest_counts,
         "Coulomb friction builds up over at least this many encoder counts (2); fewer where no encoder flickers")
      ->check(CLI::Range(0.01, 1e3));
  app.add_option("--rank", a.options.rank, "keep this many directions instead of choosing on the training data")
      ->check(CLI::Range(1, 1000));
}

std::vector<Observation> observeAll(const Robot& robot, const std::vector<std::string>& files,
                                    const IdentifyOptions& options) {
  std::vector<Observation> observations;
  for (const std::string& file : files) {
    std::cerr << "reading " << file << std::endl;
    observations.push_back(
        observe(robot, columnsOf(robot, options.joint_friction), loadRecording(file), options.observation));
  }
  return observations;
}

/// prediction_NAME.csv must be one file per recording.
void refuseEqualNames(const std::vector<Observation>& observations) {
  std::set<std::string> names;
  for (const Observation& o : observations) {
    if (!names.insert(o.name).second) {
      throw InputError(o.path + ": another validation file is named " + o.name +
                       " too, and both would write prediction_" + o.name + ".csv; rename one");
    }
  }
}

int frictionColumns(const std::vector<Column>& columns) {
  return static_cast<int>(
      std::count_if(columns.begin(), columns.end(), [](const Column& c) { return c.isFriction(); }));
}

/// A recording that the model was fitted to cannot judge it.
void refuseTrainingAgain(const Arguments& a) {
  for (const std::string& file : a.validate) {
    if (std::find(a.train.begin(), a.train.end(), file) != a.train.end()) {
      throw InputError(file + ": is given for training and for validation; choose another recording to validate with");
    }
  }
}

std::string commandLine(int argc, char** argv) {
  std::string line = "rosrun knee_robot identify";
  for (int i = 1; i < argc; ++i)
    line += std::string(" ") + argv[i];
  return line;
}

int run(const Arguments& a, const std::string& command_line) {
  IdentifyResults r;
  r.command_line = command_line;
  r.robot_path = a.robot;
  r.options = a.options;
  r.options.observation.setCutoff(a.cutoff_hz);
  refuseTrainingAgain(a);
  const Robot robot = loadRobot(a.robot);
  r.train = observeAll(robot, a.train, r.options);
  r.validate = observeAll(robot, a.validate, r.options);
  refuseEqualNames(r.validate);

  std::cerr << "fitting" << std::endl;
  r.after = identify(robot, r.train, r.options);
  IdentifyOptions without_friction =
      r.options;  // the same rigid directions, so that the difference is friction's alone
  without_friction.friction = false;
  without_friction.rank = std::max(1, r.after.model.rank - frictionColumns(r.after.columns));
  r.before = identify(robot, r.train, without_friction);

  // Both models are frozen; from here on only figures are computed.
  const double cutoff_hz = a.cutoff_hz;
  r.train_before = applyModel(r.before.model, robot, r.train, cutoff_hz);
  r.train_after = applyModel(r.after.model, robot, r.train, cutoff_hz);
  r.train_by_rank = errorAgainstRank(r.after, r.train, cutoff_hz);
  if (!r.validate.empty()) {
    for (Observation& o : r.validate)
      setCoulombWidth(o, r.after.columns, r.after.model.coulomb_width_m);
    r.validate_before = applyModel(r.before.model, robot, r.validate, cutoff_hz);
    r.validate_after = applyModel(r.after.model, robot, r.validate, cutoff_hz);
    r.validate_by_rank = errorAgainstRank(r.after, r.validate, cutoff_hz);
  }
  writeIdentifyFiles(r, a.output);
  std::cout << identifySummary(r) << "written: " << a.output << "/report.html, report.json, model.yaml and predictions"
            << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Identifies the force model of a robot from recordings.", "identify");
  Arguments arguments;
  declare(app, arguments);
  return runProgram(app, argc, argv, [&] { return run(arguments, commandLine(argc, argv)); });
}
