#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/report/trace_report.h"

namespace knee_robot::report {
namespace {

constexpr double kSame = 0.005;  ///< relative change that is not worth a word

/// Root mean square over actuators.
double together(const Eigen::VectorXd& rms_N) {
  return rms_N.norm() / std::sqrt(static_cast<double>(rms_N.size()));
}

}  // namespace

std::string traceOutcome(const TraceResults& r) {
  if (r.validate.empty())
    return "No held-out recording was given, so that nothing is known of the error elsewhere; choices rest on "
           "held-back parts of "
           "the training recordings.";
  const Eigen::VectorXd &before = r.validate_before.accuracy.rms_N, &after = r.validate_after.accuracy.rms_N;
  const double from = together(before), to = together(after), change = to / from - 1.0;
  const std::string numbers = ", rms of all actuators " + shortNumber(from, 3) + " -> " + shortNumber(to, 3) + " N";
  std::string out;
  if (std::abs(change) < kSame) {
    out = "The held-out error stayed as it was" + numbers;
  } else {
    out = std::string("The held-out error went ") + (change < 0.0 ? "DOWN" : "UP") + " by " +
          shortNumber(100.0 * std::abs(change), 2) + " %" + numbers;
  }
  for (Eigen::Index i = 0; i < before.size(); ++i) {
    if (change < kSame && after[i] > (1.0 + 6.0 * kSame) * before[i])
      out += "; on actuator " + std::to_string(i + 1) + " it went up, " + shortNumber(before[i], 3) + " -> " +
             shortNumber(after[i], 3) + " N";
  }
  return out + ".";
}

}  // namespace knee_robot::report
