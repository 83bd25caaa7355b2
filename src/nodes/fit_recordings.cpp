#include "fit_recordings.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/identification/motion_band.h"
#include "knee_robot/identification/recording_units.h"
#include "knee_robot/recording/filter.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::nodes {

void requireFitAndValidation(const std::vector<std::string>& train, const std::vector<std::string>& validate) {
  std::map<std::string, std::string> fitted;  // by what is in them: a path can be written in many ways
  for (const std::string& file : train) {
    const auto [same, is_new] = fitted.emplace(fingerprint(readFile(file)), file);
    if (is_new) continue;
    throw InputError(file + ": is given twice to fit to" +
                     (same->second == file ? "" : " (also as " + same->second + ")") +
                     ", and would count as two measurements; leave one out");
  }
  std::set<std::string> names;
  for (const std::string& file : validate) {
    if (const auto same = fitted.find(fingerprint(readFile(file))); same != fitted.end()) {
      throw InputError(file + ": is the recording that the model is fitted to" +
                       (same->second == file ? "" : " (as " + same->second + ")") +
                       "; choose another one to validate with");
    }
    const std::string name = std::filesystem::path(file).stem().string();
    if (!names.insert(name).second) {
      throw InputError(file + ": another validation file is named " + name + " too, and both would write prediction_" +
                       name + ".csv; rename one");
    }
  }
}

namespace {

constexpr double kSameTime_s = 1e-5, kSamePosition_m = 1e-7;
constexpr double kMostOfRows = 0.9;  ///< a copy may have lost its end

/// Of one measurement, written twice: a repetition never takes the same counts at every row.
bool areOneMeasurement(const recording::Recording& a, const recording::Recording& b) {
  const int rows = std::min(a.rows(), b.rows());
  if (a.axes != b.axes || rows == 0 || rows < kMostOfRows * std::max(a.rows(), b.rows())) return false;
  for (std::size_t k = 0; k < static_cast<std::size_t>(rows); ++k) {
    if (std::abs((a.time_s[k] - a.time_s[0]) - (b.time_s[k] - b.time_s[0])) > kSameTime_s) return false;
  }
  return (a.position_m.topRows(rows) - b.position_m.topRows(rows)).cwiseAbs().maxCoeff() <= kSamePosition_m;
}

}  // namespace

void requireDifferent(const std::vector<recording::Recording>& training,
                      const std::vector<recording::Recording>& validation) {
  for (std::size_t k = 0; k < training.size(); ++k) {
    for (std::size_t other = 0; other < k; ++other) {
      if (!areOneMeasurement(training[k], training[other])) continue;
      throw InputError(training[k].path + ": has the times and positions of " + training[other].path +
                       ", row by row, and would count as a second measurement; leave one out");
    }
    for (const recording::Recording& held : validation) {
      if (!areOneMeasurement(training[k], held)) continue;
      throw InputError(held.path + ": has the times and positions of " + training[k].path +
                       ", which the model is fitted to, row by row; choose another one to validate with");
    }
  }
}

std::vector<recording::Recording> readAll(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    std::cerr << "reading " << file << std::endl;
  return identification::readRecordings(files);
}

std::vector<recording::Recording> inUnits(mechanism::Robot& robot, std::vector<recording::Recording> recordings) {
  for (recording::Recording& r : recordings)
    identification::toActuatorUnits(robot, r);
  return recordings;
}

void requireFiltering(const std::vector<recording::Recording>& recordings, double cutoff_hz) {
  for (const recording::Recording& r : recordings) {
    const double rate_hz = 1.0 / recording::medianPeriod(r.time_s);
    const double highest_hz = recording::ZeroPhaseLowPass::kMostOfRate * rate_hz;
    if (cutoff_hz < highest_hz) continue;
    throw InputError("--cutoff-hz " + shortNumber(cutoff_hz) + " filters nothing in " + r.path + " with its " +
                     shortNumber(rate_hz, 4) + " rows a second; give one below " + shortNumber(highest_hz, 3) + " Hz");
  }
}

namespace {

/// The rule ends at a tenth of the rows' rate, and begins at lowest_hz.
void requireFastRows(const std::vector<recording::Recording>& training, const recording::CutoffRule& rule) {
  for (const recording::Recording& r : training) {
    const double rate_hz = 1.0 / recording::medianPeriod(r.time_s), least_hz = rule.lowest_hz / rule.share_of_rate;
    if (rate_hz > 0.99 * least_hz) continue;
    throw Refusal(r.path + ": " + shortNumber(rate_hz, 3) + " rows a second are too slow for a cut-off of " +
                  shortNumber(rule.lowest_hz, 3) + " Hz, the lowest that is chosen: record at least " +
                  shortNumber(least_hz, 3) + " a second, or give a lower one with --cutoff-hz");
  }
}

}  // namespace

recording::CutoffChoice cutoffOf(const mechanism::Robot& robot, const std::vector<recording::Recording>& training,
                                 double given_hz) {
  std::vector<const recording::Recording*> list;
  for (const recording::Recording& recording : training)
    list.push_back(&recording);
  recording::CutoffRule rule;
  for (const mechanism::Actuator& a : robot.actuators)
    rule.fastest_m_per_s.push_back(a.velocity_max_m_per_s);
  if (given_hz <= 0.0) requireFastRows(training, rule);
  recording::CutoffChoice choice = recording::chooseCutoff(list, rule);
  if (given_hz <= 0.0) return choice;
  requireFiltering(training, given_hz);
  choice.sentence = "Cut-off " + shortNumber(given_hz, 3) + " Hz, as was asked for. The rule: " + choice.sentence;
  choice.cutoff_hz = given_hz;
  return choice;
}

std::shared_ptr<const identification::Identification> chooseSmoothing(
    const mechanism::Robot& robot, const std::vector<identification::Column>& columns,
    const std::vector<recording::Recording>& recordings, identification::ObservationOptions& options,
    std::vector<identification::Observation>& training, std::string& sentence) {
  const identification::MotionBand band =
      identification::chooseMotionBand(robot, columns, recordings, training, options);
  if (band.sentence.empty()) return band.fit;
  if (band.cutoff_hz > 0.0) options.setCutoff(options.cutoff_hz, band.cutoff_hz);
  options.taut_steps = band.taut_steps;
  training = identification::observeAll(robot, columns, recordings, options);
  sentence += " " + band.sentence;
  return band.fit;
}

}  // namespace knee_robot::nodes
