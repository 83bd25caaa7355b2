// identify: force model of a robot from recordings.

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "fit_recordings.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/identification/beyond_training.h"
#include "knee_robot/identification/drive_gains.h"
#include "knee_robot/identification/gain_verdicts.h"
#include "knee_robot/identification/plausible_fit.h"
#include "knee_robot/identification/plausible_validation.h"
#include "knee_robot/identification/prediction.h"
#include "knee_robot/identification/recording_units.h"
#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/recorded_units.h"
#include "knee_robot/report/report_folder.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string robot, output;
  std::vector<std::string> train, validate;
  double cutoff_hz = 0.0;         ///< 0: by the rule
  double motion_cutoff_hz = 0.0;  ///< 0: as the encoders allow
  identification::IdentifyOptions options;
  bool physical = true;
};

void declare(nodes::CommandLine& app, Arguments& a) {
  app.option("--robot", a.robot, "robot file").required();
  app.option("--train", a.train, "recordings that the model is fitted to").required();
  app.option("--validate", a.validate,
             "recordings on which the finished model is checked; they take no part in any choice");
  app.option("--output", a.output, "folder for model.yaml, report.json, report.html and predictions").required();
  app.option("--cutoff-hz", a.cutoff_hz,
             "cut-off of the zero-phase low-pass filter of regressor and force (default: chosen from "
             "the reference of the training recordings, and printed)")
      .within(1e-6, 1e6);
  app.option("--motion-cutoff-hz", a.motion_cutoff_hz,
             "cut-off of the low-pass filter of positions before they are differentiated (default: "
             "three to five times --cutoff-hz, as the encoders allow, or wider where the encoders are fine "
             "and that leaves less of training); a lower one helps where the "
             "motion is slow and the geometry amplifies the encoders' rounding")
      .within(1e-6, 1e6);
  app.option("--rate-hz", a.options.observation.signals.rate_hz,
             "highest sampling rate of the fit (100, or twelve times the cut-off); a higher one "
             "follows reversals of friction more exactly")
      .within(1.0, 1e4);
  app.option("--moving-m-per-s", a.options.observation.moving_m_per_s,
             "an axis counts as moving above this speed (0.0015)")
      .within(0.0, 10.0);
  app.option("--condition-max", a.options.observation.condition_max,
             "samples at poses with a larger condition number of the Jacobian (m, rad) are left out "
             "(default: the robot file's margin, or 60 where that is wide open)")
      .within(1.0, 1e12);
  app.option("--fold-margin-m", a.options.observation.fold_margin_m,
             "samples whose lengths are nearer than this to a singularity where two assembly modes "
             "meet are left out (0.003); 0: the geometry is exact")
      .within(0.0, 1.0);
  app.flag("--joint-friction", a.options.joint_friction,
           "also fit friction of the legs' passive joints, as in the paper's eq. (22); needs a "
           "motion that separates it from the actuators' friction");
  app.option("--narrowest-counts", a.options.narrowest_counts,
             "shortest travel, in encoder counts, over which Coulomb friction builds up (2); less "
             "where no encoder flickers between two counts")
      .within(1e-6, 1e3);
  app.choice("--outliers", a.options.outliers,
             "how equations with large residuals are weighted: huber (default), bisquare (iteratively "
             "reweighted), none",
             {{"huber", identification::OutlierRule::Huber},
              {"bisquare", identification::OutlierRule::Bisquare},
              {"none", identification::OutlierRule::None}});
  app.flag("!--no-physical", a.physical,
           "do not fit physically consistent parameters (model_physical.yaml, identified.urdf); they"
           " need a URDF in the robot file");
  app.option("--rank", a.options.rank,
             "fit only this many directions of the parameters, without the prior (default: all "
             "directions, pulled towards the prior)")
      .within(1, 1000);
}

int frictionColumns(const std::vector<identification::Column>& columns) {
  return static_cast<int>(
      std::count_if(columns.begin(), columns.end(), [](const identification::Column& c) { return c.isFriction(); }));
}

/// The physically consistent parameters, or why there are none.
void fitPossible(const mechanism::Robot& robot, report::IdentifyResults& r) {
  if (robot.chain) {
    std::cerr << "fitting physically consistent parameters" << std::endl;
    r.urdf_path = robot.urdf;
    r.chain = robot.chain;
    r.physical = identification::fitPhysicalChain(robot, r.after);
  } else if (!robot.mechanism) {
    r.no_physical = "axes on a bench have no links.";
  } else if (robot.urdf.empty()) {
    r.no_physical = "the robot file names no URDF, so there is no prior where the data are silent.";
  } else {
    std::cerr << "fitting physically consistent parameters" << std::endl;
    r.urdf_path = robot.urdf;
    r.prior = dynamics::loadRobotInertia(robot);
    r.physical = identification::fitPhysical(robot, r.after, *r.prior);
  }
}

Eigen::MatrixXd alongObservation(const dynamics::Model& model, const mechanism::Robot& robot,
                                 const identification::Observation& o) {
  return identification::predictForce(model, robot, o.signals, o.motion);
}

/// Rows are predicted by a model of constants.
identification::ObservationOptions forRows(const report::IdentifyResults& r) {
  identification::ObservationOptions options = r.options.observation;
  options.equations = false;
  return options;
}

/// How fast rows are predicted: on training recordings, by the finished model.
void chooseBand(const mechanism::Robot& robot, const std::vector<recording::Recording>& training,
                report::IdentifyResults& r) {
  r.full_band = identification::chooseFullBand(
      robot, r.after.columns, training, forRows(r),
      [&](identification::Observation& o, int) { return alongObservation(r.after.model, robot, o); });
  r.after.model.motion_cutoff_hz = r.before.model.motion_cutoff_hz = r.full_band.motion_cutoff_hz;
  if (r.physical) r.physical->model.motion_cutoff_hz = r.full_band.motion_cutoff_hz;
}

/// A model along recordings: in the fit's band, and row by row in its own.
identification::Applied apply(const dynamics::Model& model, const mechanism::Robot& robot,
                              const report::IdentifyResults& r,
                              const std::vector<identification::Observation>& observations,
                              const std::vector<recording::Recording>& recordings) {
  identification::Applied applied = identification::applyModel(model, robot, observations, r.cutoff.cutoff_hz);
  if (model.motion_cutoff_hz == 0.0) return applied;
  for (std::size_t k = 0; k < recordings.size(); ++k)
    applied.predictions[k].row_force_N = identification::predictRows(
        robot, r.after.columns, recordings[k], forRows(r), model.motion_cutoff_hz,
        [&](identification::Observation& o, int) { return alongObservation(model, robot, o); }, -1);
  applied.accuracy = identification::accuracyOf(observations, applied.predictions);
  return applied;
}

void requireOutput(const Arguments& a, const mechanism::Robot& robot) {
  std::vector<std::string> read = a.train;
  read.insert(read.end(), {a.robot, robot.urdf});
  report::requireReportFolder({"identify", a.output, read, a.validate});
}

int run(const Arguments& a, const std::string& command_line) {
  report::Page("identify");  // what the report needs and is missing is said before the work
  report::IdentifyResults r;
  r.no_physical = "--no-physical was given.";
  r.command_line = command_line;
  r.robot_path = a.robot;
  r.options = a.options;
  nodes::requireFitAndValidation(a.train, a.validate);
  mechanism::Robot robot = mechanism::loadAnyRobot(a.robot);
  requireOutput(a, robot);
  std::vector<recording::Recording> read = nodes::readAll(a.train), read_validation = nodes::readAll(a.validate);
  nodes::requireDifferent(read, read_validation);
  identification::adaptToRecordings(robot, read);
  identification::takeRecordedSteps(robot, read);
  std::vector<recording::Recording> training = nodes::inUnits(robot, read);
  r.cutoff = nodes::cutoffOf(robot, training, a.cutoff_hz);
  r.options.observation.setCutoff(r.cutoff.cutoff_hz, a.motion_cutoff_hz);
  const std::vector<identification::Column> columns = identification::columnsOf(robot, r.options.joint_friction);
  r.train = identification::observeAll(robot, columns, training, r.options.observation);
  if (identification::gainsByUrdf(robot, r.train, r.options.observation)) {
    training = nodes::inUnits(robot, read);
    r.train = identification::observeAll(robot, columns, training, r.options.observation);
  }
  const auto tried =
      nodes::chooseSmoothing(robot, columns, training, r.options.observation, r.train, r.cutoff.sentence);
  const identification::IdentifyOptions usual;  // with which it was fitted
  if (r.options.rank == usual.rank && r.options.narrowest_counts == usual.narrowest_counts) r.options.laws_of = tried;
  const std::vector<recording::Recording> validation = nodes::inUnits(robot, read_validation);
  r.validate = identification::observeAll(robot, columns, validation, r.options.observation);
  identification::requireForces(robot, r.validate, r.options.observation);

  std::cerr << "fitting" << std::endl;
  r.after = identification::identify(robot, r.train, r.options);
  identification::judgeByGains(robot, r.after.model);
  r.drive_gains = identification::aboutGains(robot);
  r.doubts = identification::doubtsAboutFit(robot, r.after.columns, r.after.parameters, r.train, r.options.observation);
  identification::IdentifyOptions without_friction =
      r.options;  // the same rigid directions, so that the difference is friction's alone
  without_friction.friction = false;
  without_friction.rank = std::max(1, r.after.model.rank - frictionColumns(r.after.columns));
  r.before = identification::identify(robot, r.train, without_friction);

  if (a.physical) fitPossible(robot, r);
  chooseBand(robot, training, r);

  // All models are frozen; from here on only figures are computed.
  const double cutoff_hz = r.cutoff.cutoff_hz;
  r.train_before = apply(r.before.model, robot, r, r.train, training);
  r.train_after = apply(r.after.model, robot, r, r.train, training);
  for (identification::Observation& o : r.train)  // the fit without friction has left its own law in them
    identification::setFriction(o, r.after.columns, r.after.model.friction);
  r.train_by_strength = identification::errorAgainstRank(r.after, r.train, cutoff_hz);
  if (!r.validate.empty()) {
    for (identification::Observation& o : r.validate)
      identification::setFriction(o, r.after.columns, r.after.model.friction);
    r.validate_before = apply(r.before.model, robot, r, r.validate, validation);
    r.validate_after = apply(r.after.model, robot, r, r.validate, validation);
    r.validate_by_strength = identification::errorAgainstRank(r.after, r.validate, cutoff_hz);
    const std::vector<std::string> doubts =
        identification::doubtsAboutValidation(robot, r.validate, r.validate_after.predictions, r.train_after.accuracy);
    r.doubts.insert(r.doubts.end(), doubts.begin(), doubts.end());
    const std::vector<std::string> beyond = identification::beyondTraining(robot, r.train, r.validate);
    for (std::size_t k = 0; k < beyond.size(); ++k) {
      if (!beyond[k].empty()) r.validate[k].notes.push_back(beyond[k]);
    }
  }
  if (r.physical) {
    r.train_physical = apply(r.physical->model, robot, r, r.train, training);
    if (!r.validate.empty()) r.validate_physical = apply(r.physical->model, robot, r, r.validate, validation);
  }
  report::toRecordedUnits(robot, r);
  report::writeIdentifyFiles(r, a.output);
  std::cout << report::withUnits(r.units, report::identifySummary(r)) << "written: " << a.output
            << "/report.html, report.json, model.yaml and predictions" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Identifies the force model of a robot from recordings.", "identify");
  Arguments arguments;
  declare(app, arguments);
  return nodes::runProgram(app, argc, argv, [&] { return run(arguments, nodes::commandLine("identify", argc, argv)); });
}
