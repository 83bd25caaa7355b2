// trace: what is the residual of the rigid model with friction made of?

#include <algorithm>
#include <iostream>

#include "fit_recordings.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/identification/beyond_training.h"
#include "knee_robot/identification/drive_gains.h"
#include "knee_robot/identification/full_band.h"
#include "knee_robot/identification/gain_verdicts.h"
#include "knee_robot/identification/plausible_validation.h"
#include "knee_robot/identification/recording_units.h"
#include "knee_robot/recording/pauses.h"
#include "knee_robot/recording/signals.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/recorded_units.h"
#include "knee_robot/report/report_folder.h"
#include "knee_robot/report/trace_report.h"
#include "knee_robot/tracing/model_prediction.h"
#include "program.h"

using namespace knee_robot;

namespace {

struct Arguments {
  std::string robot, output, model;
  std::vector<std::string> train, validate;
  double cutoff_hz = 0.0;         ///< 0: by the rule
  double motion_cutoff_hz = 0.0;  ///< 0: as the encoders allow
  tracing::TraceOptions options;
  nodes::Option given_model;
};

void declare(nodes::CommandLine& app, Arguments& a) {
  app.option("--robot", a.robot, "robot file").required();
  app.option("--train", a.train, "training recordings: their residual is traced, and every choice is made on them")
      .required();
  app.option("--validate", a.validate,
             "recordings on which the finished model is checked; they take no part in any choice");
  app.option("--output", a.output, "folder for model.yaml, report.json, report.html and predictions").required();
  a.given_model = app.option("--model", a.model,
                             "model of identify or trace to start from, with its cut-off. 'before' means this model "
                             "unchanged; its effects are re-tested, then only missing ones are searched");
  app.option("--max-effects,--most", a.options.most_effects,
             "largest number of effects to add (6); the same effect on several actuators counts once; "
             "0: the baseline model only")
      .within(0, 20);
  app.option("--seed", a.options.seed, "random seed for surrogate recordings and bootstrap (1)");
  app.option("--cutoff-hz", a.cutoff_hz,
             "cut-off of the zero-phase low-pass filter of regressor and force (default: chosen from "
             "the reference of the training recordings, as identify does); not with --model")
      .within(1e-6, 1e6);
  app.option("--motion-cutoff-hz", a.motion_cutoff_hz,
             "low-pass of the positions before they are differentiated (default: as the encoders allow, as identify "
             "does); not with --model")
      .within(1e-6, 1e6);
  app.option("--moving-m-per-s", a.options.observation.moving_m_per_s,
             "an axis counts as moving above this speed (0.0015)")
      .within(0.0, 10.0);
}

constexpr double kLongestPause_s =
    2.0;  ///< longer ones are closed: nothing happens in them, and every sample costs time

using Times = std::vector<std::vector<double>>;  ///< of every recording's rows, before pauses were closed

std::vector<recording::Recording> readWithoutPauses(const std::vector<std::string>& files, Times& times) {
  std::vector<recording::Recording> recordings = nodes::readAll(files);
  for (recording::Recording& r : recordings) {
    times.push_back(r.time_s);
    recording::closePauses(r, kLongestPause_s);
  }
  return recordings;
}

void giveTimesBack(const Times& times, std::vector<identification::Observation>& observations) {
  for (std::size_t k = 0; k < observations.size(); ++k)
    observations[k].row_time_s = times[k];
}

/// What a prediction along recordings needs.
struct Along {
  const mechanism::Robot& robot;
  identification::ObservationOptions options;
  double motion_cutoff_hz = 0.0;  ///< of rows; 0: that of the fit
};

/// In the fit's band, and row by row in the full one, where `rows` predicts them.
identification::Applied apply(const Along& along, std::vector<identification::Observation>& observations,
                              const std::vector<recording::Recording>& recordings,
                              const identification::RowPredictor& predict, const identification::RowPredictor& rows) {
  identification::Applied applied;
  if (observations.empty()) return applied;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const int index = static_cast<int>(k);
    applied.predictions.push_back(
        identification::makePrediction(observations[k], predict(observations[k], index), along.options.cutoff_hz));
    if (recordings.empty()) continue;
    applied.predictions.back().row_force_N =
        along.motion_cutoff_hz == 0.0
            ? recording::atHoldIntervals(observations[k].signals, rows(observations[k], index),
                                         observations[k].row_time_s)
            : identification::predictRows(along.robot, identification::columnsOf(along.robot), recordings[k],
                                          along.options, along.motion_cutoff_hz, rows, index);
  }
  applied.accuracy = identification::accuracyOf(observations, applied.predictions);
  return applied;
}

/// Fall of the validation rms when effect k is put back into the finished model.
std::vector<Eigen::VectorXd> gains(const Along& along, report::TraceResults& r) {
  std::vector<Eigen::VectorXd> out;
  for (std::size_t k = 0; k < r.result.effects.size(); ++k) {
    tracing::TraceResult without = r.result;
    const tracing::Place place = without.effects[k].hypothesis.place;
    without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(k));
    if (without.elsewhere) {
      tracing::TraceResult other = *without.elsewhere;
      other.effects.erase(std::remove_if(other.effects.begin(), other.effects.end(),
                                         [&](const tracing::FoundEffect& e) { return e.hypothesis.place == place; }),
                          other.effects.end());
      without.elsewhere = std::make_shared<const tracing::TraceResult>(std::move(other));
    }
    const auto predict = [&](identification::Observation& o, int) {
      return tracing::predictTraced(along.robot, without, o, -1, static_cast<int>(r.train.size()));
    };
    const identification::Applied applied = apply(along, r.validate, {}, predict, predict);
    out.push_back(applied.accuracy.rms_N - r.validate_after.accuracy.rms_N);
  }
  return out;
}

tracing::PoseTraceOptions poseOptions(const mechanism::Robot& robot, const tracing::TraceOptions& options) {
  tracing::PoseTraceOptions pose;
  pose.condition_max = identification::conditionLimit(robot, options.observation);
  pose.seed = options.seed;
  pose.progress = options.progress;
  return pose;
}

/// Adapts and observes what the search may see; the robot's units and encoder steps are read off it.
std::vector<recording::Recording> observeTraining(const Arguments& a, mechanism::Robot& robot, report::TraceResults& r,
                                                  recording::CutoffChoice& cutoff,
                                                  std::vector<recording::Recording> read) {
  identification::adaptToRecordings(robot, read);
  identification::takeRecordedSteps(robot, read);
  if (!a.model.empty()) {
    r.options.start =
        std::make_shared<const tracing::StartModel>(tracing::StartModel{dynamics::loadModel(a.model), a.model});
    dynamics::requireModelOf(r.options.start->model, a.model, robot);
    identification::takeGains(r.options.start->model, robot);
  }
  std::vector<recording::Recording> train = nodes::inUnits(robot, read);
  cutoff = nodes::cutoffOf(robot, train, a.cutoff_hz);
  if (r.options.start) {
    cutoff.cutoff_hz = r.options.start->model.cutoff_hz;
    cutoff.sentence = "Cut-off " + shortNumber(cutoff.cutoff_hz, 3) + " Hz, of the given model.";
  }
  r.options.observation.setCutoff(cutoff.cutoff_hz,
                                  r.options.start ? r.options.start->model.fit_motion_cutoff_hz : a.motion_cutoff_hz);
  if (r.options.start) r.options.observation.taut_steps = r.options.start->model.fit_taut_steps;
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  r.train = identification::observeAll(robot, columns, train, r.options.observation);
  if (identification::gainsByUrdf(robot, r.train, r.options.observation)) {
    train = nodes::inUnits(robot, read);
    r.train = identification::observeAll(robot, columns, train, r.options.observation);
  }
  if (!r.options.start)
    r.options.laws_of = nodes::chooseSmoothing(robot, columns, train, r.options.observation, r.train, cutoff.sentence);
  if (r.options.rank > 0) r.options.laws_of = nullptr;  // those of all directions
  return train;
}

/// Before and after, on both sets of recordings. The model is frozen: only figures are computed, and how fast rows are
/// predicted is read off training.
void applyModels(const Arguments& a, const mechanism::Robot& robot, const std::vector<recording::Recording>& train,
                 const std::vector<recording::Recording>& validate, report::TraceResults& r) {
  const int count = static_cast<int>(r.train.size());
  const auto before = [&](identification::Observation& o, int) -> Eigen::MatrixXd {
    if (r.options.start) return tracing::predictModel(robot, r.options.start->model, a.model, o);
    return tracing::predictBaseline(r.result, o);
  };
  const auto after = [&](identification::Observation& o, int k) {
    return tracing::predictTraced(robot, r.result, o, k, count);
  };
  const auto elsewhere = [&](identification::Observation& o, int) {
    return tracing::predictTraced(robot, r.result, o, -1, count);
  };
  // Rows of the baseline as identify predicts them: instant by instant, as fast as its own error allows.
  const dynamics::Model baseline =
      r.options.start ? r.options.start->model : tracing::baselineModel(robot, r.result, r.train, r.options);
  const auto baseline_rows = [&](identification::Observation& o, int) {
    return tracing::predictModel(robot, baseline, a.model, o);
  };
  const auto choose = [&](const identification::ObservationOptions& options,
                          const identification::RowPredictor& predict) {
    return identification::chooseFullBand(robot, identification::columnsOf(robot), train, options, predict);
  };
  identification::ObservationOptions for_baseline = r.options.observation;
  for_baseline.equations = !baseline.effects.empty() || !baseline.effects_see.empty();
  const Along simple = {robot, r.options.observation, choose(for_baseline, baseline_rows).motion_cutoff_hz};
  const identification::FullBand band = choose(r.options.observation, after);
  r.result.notes.push_back(band.sentence);
  r.model.motion_cutoff_hz = band.motion_cutoff_hz;
  const Along along = {robot, r.options.observation, band.motion_cutoff_hz};
  r.train_before = apply(simple, r.train, train, before, baseline_rows);
  r.train_after = apply(along, r.train, train, after, after);
  r.validate_before = apply(simple, r.validate, validate, before, baseline_rows);
  r.validate_after = apply(along, r.validate, validate, elsewhere, elsewhere);
  if (!r.validate.empty()) r.validate_gain_N = gains(along, r);
}

/// Says which validation recordings the given model has seen.
void noteSeenRecordings(report::TraceResults& r) {
  if (!r.options.start) return;
  for (const identification::Observation& o : r.validate) {
    for (const dynamics::ModelData& data : r.options.start->model.data) {
      if (data.fingerprint == o.fingerprint)
        r.result.notes.push_back(o.path +
                                 ": the given model was fitted on this validation recording, so "
                                 "that before is flattered there.");
    }
  }
}

/// What would not be looked at would be taken for kept.
void requireModelOptions(const Arguments& a) {
  if (!a.given_model.given()) return;
  if (a.model.empty()) throw InputError("--model has an empty name; give a model file, or leave it out");
  for (const auto& [name, hz] : {std::pair("--cutoff-hz", a.cutoff_hz), {"--motion-cutoff-hz", a.motion_cutoff_hz}}) {
    if (hz > 0.0)
      throw InputError(std::string(name) + " does not go with --model, whose own cut-off is kept; leave one out");
  }
}

void requireOutput(const Arguments& a, const mechanism::Robot& robot) {
  std::vector<std::string> read = a.train;
  read.insert(read.end(), {a.robot, robot.urdf, a.model});
  report::requireReportFolder({"trace", a.output, read, a.validate});
}

int run(const Arguments& a, const std::string& command_line) {
  report::Page("trace");  // what the report needs and is missing is said before the work
  requireModelOptions(a);
  nodes::requireFitAndValidation(a.train, a.validate);
  report::TraceResults r;
  r.command_line = command_line;
  r.robot_path = a.robot;
  r.options = a.options;
  r.options.progress = [](const std::string& what) { std::cerr << what << std::endl; };
  if (a.options.most_effects == 0) r.options.surrogates = 2;  // nothing is compared with surrogates
  mechanism::Robot robot = mechanism::loadAnyRobot(a.robot);
  requireOutput(a, robot);
  Times train_times, validate_times;
  recording::CutoffChoice cutoff;
  const std::vector<recording::Recording> read = readWithoutPauses(a.train, train_times),
                                          read_validation = readWithoutPauses(a.validate, validate_times);
  nodes::requireDifferent(read, read_validation);
  const std::vector<recording::Recording> train = observeTraining(a, robot, r, cutoff, read);
  const std::vector<recording::Recording> validate = nodes::inUnits(robot, read_validation);
  r.validate = identification::observeAll(robot, identification::columnsOf(robot), validate, r.options.observation);
  identification::requireForces(robot, r.validate, r.options.observation);

  r.result = tracing::trace(robot, train, r.train, r.options);
  r.result.notes.push_back(cutoff.sentence);
  for (const std::string& sentence : identification::aboutGains(robot))
    r.result.notes.push_back(sentence);
  r.model = tracing::tracedModel(robot, r.result, r.train, r.options);
  applyModels(a, robot, train, validate, r);
  for (const std::vector<identification::Observation>* const recorded : {&r.train, &r.validate}) {
    const std::vector<std::string> warnings = identification::warningsOf(*recorded);
    r.result.doubts.insert(r.result.doubts.end(), warnings.begin(), warnings.end());
  }
  if (!r.validate.empty()) {
    const std::vector<std::string> doubts = identification::doubtsAboutValidation(
        robot, r.validate, r.validate_before.predictions, r.train_before.accuracy);
    r.result.doubts.insert(r.result.doubts.end(), doubts.begin(), doubts.end());
    const std::vector<std::string> beyond = identification::beyondTraining(robot, r.train, r.validate);
    for (std::size_t k = 0; k < beyond.size(); ++k) {
      if (!beyond[k].empty()) r.result.notes.push_back(r.validate[k].path + ": " + beyond[k]);
    }
  }
  r.next = tracing::planNextExperiment(robot, r.result, r.train, r.options);
  noteSeenRecordings(r);
  r.pose = tracing::tracePose(robot, train, validate, poseOptions(robot, r.options));

  giveTimesBack(train_times, r.train);
  giveTimesBack(validate_times, r.validate);
  report::toRecordedUnits(robot, r);
  report::writeTraceFiles(r, a.output);
  std::cout << report::withUnits(r.units, report::traceSummary(r)) << "written: " << a.output
            << "/report.html, report.json, model.yaml and predictions" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Traces the residual of the rigid model with friction to the effects that the model lacks.",
                         "trace");
  Arguments arguments;
  declare(app, arguments);
  return nodes::runProgram(app, argc, argv, [&] { return run(arguments, nodes::commandLine("trace", argc, argv)); });
}
