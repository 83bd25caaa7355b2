#include "knee_robot/recording/test_pulses.h"

#include <utility>

#include "knee_robot/base/numbers.h"

namespace knee_robot::recording {
namespace {

constexpr double kSettle_s = 0.05;  ///< after a pulse

/// First and one past the last row of every stretch with pulses, the robot's coming to rest included.
std::vector<std::pair<int, int>> stretches(const Recording& r) {
  std::vector<std::pair<int, int>> all;
  double quiet_from_s = 0.0;
  for (int k = 0; k < r.rows(); ++k) {
    const double time_s = r.time_s[static_cast<std::size_t>(k)];
    const bool begins = all.empty() || time_s >= quiet_from_s;
    const bool asks = r.test_pulse[k] != 0.0;
    if (asks) quiet_from_s = time_s + kSettle_s;
    if (begins && asks) all.emplace_back(k, k + 1);
    if (!begins) all.back().second = k + 1;
  }
  return all;
}

/// A straight line from the row before to the row after; at an end of the recording the row that there is.
void bridge(const std::vector<double>& time_s, int from, int to, Eigen::MatrixXd& signal) {
  if (signal.cols() == 0) return;
  const int before = from > 0 ? from - 1 : to, after = to < signal.rows() ? to : from - 1;
  const double from_s = time_s[static_cast<std::size_t>(before)];
  const double span_s = time_s[static_cast<std::size_t>(after)] - from_s;
  const Eigen::RowVectorXd first = signal.row(before), last = signal.row(after);
  for (int k = from; k < to; ++k) {
    const double s = span_s != 0.0 ? (time_s[static_cast<std::size_t>(k)] - from_s) / span_s : 0.0;
    signal.row(k) = (1.0 - s) * first + s * last;
  }
}

}  // namespace

void bridgeTestPulses(Recording& r) {
  if (r.test_pulse.size() == 0) return;
  int bridged = 0;
  for (const auto& [from, to] : stretches(r)) {
    if (to - from == r.rows()) return;
    for (Eigen::MatrixXd* signal : {&r.command_V, &r.force_N, &r.current_A})
      bridge(r.time_s, from, to, *signal);
    r.test_pulse.segment(from, to - from).setOnes();
    bridged += to - from;
  }
  if (bridged == 0) return;
  r.notes.push_back("In " + shortNumber(100.0 * bridged / r.rows(), 3) +
                    " % of the rows the controller asked encoders whether they count, or the robot came to rest from "
                    "it; they are not used.");
}

}  // namespace knee_robot::recording
