// What a chain's robot file leaves open and its recordings tell: which joints stand, the encoders' steps.

#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "knee_robot/dynamics/chain_regressor.h"
#include "knee_robot/identification/recording_units.h"
#include "knee_robot/recording/test_pulses.h"

namespace knee_robot::identification {
namespace {

constexpr double kStands_rad = 0.01, kStands_m = 0.001;  ///< a joint that goes less far in all recordings stands still
constexpr double kFinestStep = 1e-7;                     ///< rad or m: less is a computer's rounding, no encoder's

/// Which joints stand in all recordings; empty when columns and joints are not the same in number.
std::vector<char> standing(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings) {
  std::vector<char> stands(robot.actuators.size(), 1);
  for (const recording::Recording& r : recordings) {
    if (r.axes != robot.axes()) return {};
    for (int i = 0; i < r.axes; ++i) {
      const double least = robot.actuators[static_cast<std::size_t>(i)].revolute ? kStands_rad : kStands_m;
      if (r.position_m.col(i).maxCoeff() - r.position_m.col(i).minCoeff() > least)
        stands[static_cast<std::size_t>(i)] = 0;
    }
  }
  return stands;
}

void lock(mechanism::Robot& robot, const std::vector<char>& stands, std::vector<recording::Recording>& recordings) {
  const Eigen::VectorXd at = recordings.front().position_m.colwise().mean();
  robot.chain = mechanism::lockedAt(*robot.chain, stands, at);
  std::string names;
  std::vector<mechanism::Actuator> moving;
  for (std::size_t i = 0; i < stands.size(); ++i) {
    if (!stands[i]) {
      moving.push_back(robot.actuators[i]);
      continue;
    }
    names += (names.empty() ? "" : ", ") + robot.actuators[i].name + " at " +
             shortNumber(at[static_cast<Eigen::Index>(i)], 4) + " " + mechanism::positionUnit(robot.actuators[i]);
  }
  robot.actuators = moving;
  recordings.front().notes.push_back("Joints that stand still in all recordings were locked: " + names + ".");
}

/// Smallest change between neighbouring rows.
double stepOf(const std::vector<recording::Recording>& recordings, int column) {
  double step = std::numeric_limits<double>::infinity();
  for (const recording::Recording& r : recordings) {
    for (Eigen::Index k = 0; k + 1 < r.position_m.rows(); ++k) {
      const double change = std::abs(r.position_m(k + 1, column) - r.position_m(k, column));
      if (change > 0.5 * kFinestStep) step = std::min(step, change);
    }
  }
  return step;
}

}  // namespace

std::vector<recording::Recording> readRecordings(const std::vector<std::string>& files) {
  std::vector<recording::Recording> recordings;
  for (const std::string& file : files)
    recording::bridgeTestPulses(recordings.emplace_back(recording::loadRecording(file)));
  return recordings;
}

void adaptToRecordings(mechanism::Robot& robot, std::vector<recording::Recording>& recordings) {
  if (!robot.chain || recordings.empty()) return;
  const std::string impossible = joined(dynamics::impossibleLinks(*robot.chain));
  if (!impossible.empty())
    recordings.front().notes.push_back("The URDF's inertia of " + impossible +
                                       " is one that no body can have; the nearest possible one is the prior.");
  const std::vector<char> stands = standing(robot, recordings);
  for (std::size_t i = 0; i < stands.size(); ++i) {
    mechanism::Actuator& a = robot.actuators[i];
    if (a.resolution_given || stands[i]) continue;
    const double step = stepOf(recordings, static_cast<int>(i));
    if (std::isfinite(step)) a.counts_per_revolution = (a.revolute ? kTwoPi : 1.0) / std::max(step, kFinestStep);
  }
  const auto count = std::count(stands.begin(), stands.end(), 1);
  if (count > 0 && count < static_cast<std::ptrdiff_t>(stands.size())) lock(robot, stands, recordings);
}

}  // namespace knee_robot::identification
