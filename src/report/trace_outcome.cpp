#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/report/trace_report.h"

namespace knee_robot::report {
namespace {

constexpr double kSame = 0.005;  ///< relative change that is not worth a word

/// Root mean square over actuators of which something is known; 0 when there is none.
double together(const Eigen::VectorXd& rms_N) {
  double sum = 0.0, count = 0.0;
  for (const double rms : rms_N) {
    if (!std::isfinite(rms)) continue;
    sum += rms * rms;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

/// What an error did: "went DOWN by 7 %" and its numbers.
struct Change {
  Change(const Eigen::VectorXd& before_N, const Eigen::VectorXd& after_N)
      : from(together(before_N)), to(together(after_N)) {}
  double relative() const { return from > 0.0 ? to / from - 1.0 : 0.0; }
  int direction() const { return std::abs(relative()) < kSame ? 0 : relative() < 0.0 ? -1 : 1; }
  std::string words() const {
    if (direction() == 0) return "stayed as it was";
    return std::string("went ") + (direction() < 0 ? "DOWN" : "UP") + " by " +
           shortNumber(100.0 * std::abs(relative()), 2) + " %";
  }
  std::string numbers() const { return shortNumber(from, 3) + " -> " + shortNumber(to, 3) + " N"; }

  double from, to;
};

/// Where the rest before a movement decides over the whole: it says nothing of the model.
std::string sinceMovedText(const TraceResults& r, const Change& all) {
  const Change since(r.validate_before.accuracy.rms_since_moved_N, r.validate_after.accuracy.rms_since_moved_N);
  if (!(since.from > 0.0) || since.direction() == all.direction()) return "";
  return "; from each axis's first movement on it " + since.words() + ", " + since.numbers() +
         " (before that, no recording tells what friction holds)";
}

}  // namespace

std::string traceOutcome(const TraceResults& r) {
  if (r.validate.empty())
    return "No held-out recording was given, so that nothing is known of the error elsewhere; choices rest on "
           "held-back parts of "
           "the training recordings.";
  const Eigen::VectorXd &before = r.validate_before.accuracy.rms_N, &after = r.validate_after.accuracy.rms_N;
  const Change all(before, after);
  std::string out = "The held-out error " + all.words() + ", rms of all actuators " + all.numbers();
  for (Eigen::Index i = 0; i < before.size(); ++i) {
    if (all.relative() < kSame && after[i] > (1.0 + 6.0 * kSame) * before[i])
      out += "; on actuator " + std::to_string(i + 1) + " it went up, " + shortNumber(before[i], 3) + " -> " +
             shortNumber(after[i], 3) + " N";
  }
  return out + sinceMovedText(r, all) + ".";
}

}  // namespace knee_robot::report
