// The steps in which positions were recorded: a robot file may be of a sister machine, or count quadrature otherwise.

#include <cmath>
#include <limits>

#include "knee_robot/base/numbers.h"
#include "knee_robot/identification/recording_units.h"

namespace knee_robot::identification {
namespace {

constexpr double kFinestStep_m = 1e-8;  ///< less is a computer's rounding, no encoder's
constexpr double kMostSteps = 20.0;     ///< in a change that is looked at: of more the step's own error is too large
constexpr double kOffGrid = 0.1;        ///< of a step, by which a change may miss a multiple of it
constexpr double kOnGrid = 0.98;        ///< least share of changes that are multiples
constexpr int kFewest = 50;             ///< changes
constexpr double kSame = 0.05;          ///< difference to the robot file's that is none

template <typename Use>
void forChanges(const std::vector<recording::Recording>& recordings, int column, const Use& use) {
  for (const recording::Recording& r : recordings) {
    for (Eigen::Index k = 0; k + 1 < r.position_m.rows(); ++k) {
      const double change = std::abs(r.position_m(k + 1, column) - r.position_m(k, column));
      if (change > kFinestStep_m) use(change);
    }
  }
}

/// Step of which all small changes of a column are multiples, m; 0: there is none (positions were filtered, or rounded
/// to something else).
double recordedStep(const std::vector<recording::Recording>& recordings, int column) {
  double step = std::numeric_limits<double>::infinity(), sum = 0.0, steps = 0.0;
  forChanges(recordings, column, [&](double change) { step = std::min(step, change); });
  int small = 0, on = 0;
  forChanges(recordings, column, [&](double change) {
    const double multiple = std::round(change / step);
    if (multiple > kMostSteps) return;
    ++small;
    if (std::abs(change / step - multiple) > kOffGrid) return;
    ++on;
    sum += change;
    steps += multiple;
  });
  return small >= kFewest && on >= kOnGrid * small ? sum / steps : 0.0;
}

}  // namespace

void takeRecordedSteps(mechanism::Robot& robot, std::vector<recording::Recording>& recordings) {
  if (robot.chain || recordings.empty()) return;
  for (const recording::Recording& r : recordings) {
    if (r.axes != robot.axes()) return;  // refused where it is read
  }
  for (int i = 0; i < robot.axes(); ++i) {
    mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    const double step_m = recordedStep(recordings, i), declared_m = a.metresPerCount();
    if (step_m <= 0.0 || std::abs(step_m - declared_m) <= kSame * declared_m) continue;
    recordings.front().notes.push_back("Actuator " + std::to_string(i + 1) + ": positions were recorded in steps of " +
                                       shortNumber(1e6 * step_m, 3) + " um, by the robot file they are " +
                                       shortNumber(1e6 * declared_m, 3) +
                                       " um (screw_lead_m / counts_per_revolution): the recorded ones are used.");
    a.counts_per_revolution = a.screw_lead_m / step_m;
  }
}

}  // namespace knee_robot::identification
