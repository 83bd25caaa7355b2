#include <algorithm>
#include <cmath>
#include <vector>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "knee_robot/report/trace_report.h"
#include "number_row.h"
#include "trace_angles_report.h"
#include "trace_given_report.h"
#include "trace_next_report.h"
#include "trace_pose_report.h"

namespace knee_robot::report {
namespace {

constexpr double kUnmet =
    2.0;  ///< times the error of training, and the noise floor: something that training has not met

std::string side(const std::string& title, const identification::Applied& before,
                 const identification::Applied& after) {
  std::string out = title + ", rms, N" + "\n";
  out +=
      numberRow("before, all samples", before.accuracy.rms_N) + numberRow("after, all samples", after.accuracy.rms_N);
  Eigen::VectorXd together(2);
  together << before.accuracy.togetherPercent(), after.accuracy.togetherPercent();
  return out + numberRow("before, moving samples", before.accuracy.rms_moving_N) +
         numberRow("after, moving samples", after.accuracy.rms_moving_N) +
         numberRow("before, rows, full band", before.accuracy.rms_raw_N) +
         numberRow("after, rows, full band", after.accuracy.rms_raw_N) +
         numberRow("% of rms(force), all together: before, after", together);
}

/// What is doubted, or has more than two rivals, has no name of its own.
std::string nameOf(const tracing::FoundEffect& e, const dynamics::ModelEffect& m) {
  if (e.doubted) return "unnamed (looks like " + m.name + ")";
  return e.isOneOfMany() ? "unnamed (" + m.name + ", " + joined(e.indistinguishable_from) + " are not told apart)"
                         : m.name;
}

std::string effectLine(const tracing::FoundEffect& e, const dynamics::ModelEffect& m) {
  std::string out =
      "  " + nameOf(e, m) +
      (m.actuators.size() == 1 ? " on actuator " + std::to_string(m.actuators.front()) : " on all actuators");
  if (!m.depends_on.empty()) {
    out += ", depends on " + m.depends_on;
  } else {
    for (const auto* list : {&m.shape, &m.coefficients}) {
      for (const dynamics::EffectParameter& p : *list)
        out += ", " + p.name + " = " + shortNumber(p.value, 3);
    }
  }
  out += "; explains " + shortNumber(e.explained_rms_N.maxCoeff(), 3) + " N";
  out += std::isfinite(e.p) ? ", p = " + shortNumber(e.p, 2) : std::string(", of the given model");
  for (std::size_t k = 0; !e.isOneOfMany() && k < e.indistinguishable_from.size(); ++k)
    out += (k ? ", " : "; not told from ") + e.indistinguishable_from[k];
  const bool named = !e.isOneOfMany() && !e.hypothesis.place.candidate->isMap() && std::isfinite(e.p);
  if (named) out += "; probability of the name " + shortNumber(tracing::probabilityOfName(e), 2);
  return out + (m.transfers ? "\n" : "; does not transfer\n");
}

std::string addedText(const TraceResults& r) {
  const tracing::TraceResult& t = r.result;
  bool above = false;
  for (Eigen::Index i = 0; i < t.floor_N.size(); ++i)
    above = above || t.before_rms_N[i] > 1.15 * t.floor_N[i];
  if (!t.effects.empty()) {
    std::string names, kept;
    for (std::size_t k = 0; k < t.effects.size(); ++k) {
      const dynamics::ModelEffect& m = r.model.effects[k];
      if (std::isnan(t.effects[k].p)) {
        kept += (kept.empty() ? " Kept of the given model: " : ", ") + m.name +
                (m.actuators.size() == 1 ? " (actuator " + std::to_string(m.actuators.front()) + ")" : "");
        continue;
      }
      names += (names.empty() ? "" : ", ") + nameOf(t.effects[k], m) +
               (m.actuators.size() == 1 ? " (actuator " + std::to_string(m.actuators.front()) + ")" : "");
      for (std::size_t i = 0; !t.effects[k].isOneOfMany() && i < t.effects[k].indistinguishable_from.size(); ++i)
        names += " or " + t.effects[k].indistinguishable_from[i];
    }
    if (!kept.empty()) kept += ".";
    return (names.empty() ? "Nothing was added to the given model." : "Added to the model: " + names + ".") + kept;
  }
  if (!above) return "There is nothing to explain: the baseline's residual is at the noise floor. Nothing was added.";
  return "The residual is above the floor, but no effect explains it better than surrogates do by chance. Nothing was "
         "added.";
}

/// Which actuators leave much more on the held-out recordings than training and floor would let one expect.
std::vector<Eigen::Index> unmet(const TraceResults& r, Eigen::VectorXd identification::Accuracy::*rms,
                                const Eigen::VectorXd& trained) {
  const Eigen::VectorXd& there = r.validate_after.accuracy.*rms;
  std::vector<Eigen::Index> axes;
  for (Eigen::Index i = 0; i < there.size(); ++i) {
    if (there[i] > kUnmet * trained[i] && there[i] > kUnmet * r.result.floor_N[i]) axes.push_back(i);
  }
  return axes;
}

std::string listed(const std::vector<Eigen::Index>& axes, const Eigen::VectorXd& values) {
  return joined(axes, [&](Eigen::Index i) { return shortNumber(values[i], 3); }) + " N";
}

/// Something acts there and not in training; or what was added is wrong there, where the model before was better.
std::string whyUnmet(const TraceResults& r, Eigen::Index i) {
  const double before = r.validate_before.accuracy.rms_moving_N[i];
  if (r.result.effects.empty() || !(kUnmet * before < r.validate_after.accuracy.rms_moving_N[i]))
    return ": what acts there hardly acts in training";
  return " (before " + shortNumber(before, 3) + " N): what was added is wrong there";
}

/// What acts in the held-out recordings and hardly in those of training cannot be found: which to train on as well.
std::string unmetText(const TraceResults& r) {
  if (r.validate.empty()) return "";
  const identification::Accuracy &before = r.train_before.accuracy, &after = r.train_after.accuracy,
                                 &there = r.validate_after.accuracy;
  const Eigen::VectorXd moving = before.rms_moving_N.cwiseMax(after.rms_moving_N),
                        resting = before.rms_resting_N.cwiseMax(after.rms_resting_N);
  std::string out;
  for (const Eigen::Index i : unmet(r, &identification::Accuracy::rms_moving_N, moving))
    out += " On the held-out recordings actuator " + std::to_string(i + 1) + " leaves " +
           shortNumber(there.rms_moving_N[i], 3) + " N while it moves, on those of training " +
           shortNumber(moving[i], 3) + " N" + whyUnmet(r, i) +
           "; trace with such a movement among the training recordings.";
  const std::vector<Eigen::Index> rest = unmet(r, &identification::Accuracy::rms_resting_N, resting);
  if (rest.empty()) return out;
  return out + " At rest " + (rest.size() > 1 ? "actuators " : "actuator ") +
         joined(rest, [](Eigen::Index i) { return std::to_string(i + 1); }) +
         (rest.size() > 1 ? " leave " : " leaves ") + listed(rest, there.rms_resting_N) +
         " on the held-out recordings, " + listed(rest, resting) +
         " on those of training: how friction acts near rest shows in slow movements with stops" +
         (r.units.plain() ? " (plan_excitation --near-rest plans one)" : "") +
         "; trace with such a movement among the training recordings.";
}

}  // namespace

std::string traceVerdict(const TraceResults& r) {
  const std::string &presliding = r.result.presliding, &stiction = r.result.stiction;
  return addedText(r) + (presliding.empty() ? "" : " The baseline has presliding: " + presliding + ".") +
         (stiction.empty() ? "" : " The baseline has stiction: " + stiction + ".") + unmetText(r);
}

/// The payload beside a given model, which is no column of its own.
std::string payloadLine(const tracing::PayloadTest& p) {
  return p.is_effect ? "Payload: " + p.sentence + "\n" : "";
}

std::string traceSummary(const TraceResults& r) {
  std::string out = traceOutcome(r) + "\n";
  for (const std::string& doubt : r.result.doubts)
    out += doubt + "\n";
  for (const std::string& note : r.result.notes)
    out += note + "\n";
  out += givenModelSummary(r.result.given) + "\n" + payloadLine(r.result.payload) + traceVerdict(r) + "\n";
  for (std::size_t k = 0; k < r.result.effects.size(); ++k)
    out += effectLine(r.result.effects[k], r.model.effects[k]);
  out += anglesSummary(r);
  out += numberRow("floor, N", r.result.floor_N) + side("training", r.train_before, r.train_after);
  if (!r.validate.empty()) out += side("validation", r.validate_before, r.validate_after);
  out += errorSharesSummary(r);
  return out + nextExperimentSummary(r.next) + tracePoseSummary(r.pose);
}

}  // namespace knee_robot::report
