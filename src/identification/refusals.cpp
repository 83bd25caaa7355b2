#include "refusals.h"

#include <algorithm>
#include <string>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "masking.h"
#include "other_forces.h"

namespace knee_robot::identification {
namespace {

constexpr double kShortestMotion_s = 2.0;
constexpr double kNoMotion_m_per_s = 1e-9;
constexpr double kMostLeftOut = 0.1;    ///< of the samples, for one reason: less does not shorten a recording much
constexpr double kMostSaturated = 0.2;  ///< of the samples

/// What most samples of the recordings are left out for, as the end of a sentence.
std::string leftOutOf(const std::vector<Observation>& training) {
  std::string out;
  for (const Observation& o : training) {
    for (const Mask& mask : o.masks) {
      if (mask.share > kMostLeftOut && mask.reason.rfind("used in", 0) != 0)
        out += (out.empty() ? " without what is left out: " : ", ") + shortNumber(100.0 * mask.share, 3) + " % of " +
               o.name + " (" + mask.reason + ")";
    }
  }
  return out;
}

}  // namespace

std::string namesOf(const std::vector<Observation>& training) {
  return joined(training, [](const Observation& o) { return o.path; });
}

void refuseSaturated(const std::vector<Observation>& training) {
  for (const Observation& o : training) {
    if (o.saturated_share <= kMostSaturated) continue;
    throw Refusal(o.path + ": a command is at its limit" +
                  (o.clipped.empty() ? "" : " (" + o.clipped + ", its own extreme)") + " in " +
                  shortNumber(100.0 * o.saturated_share, 3) +
                  " % of the samples (at most 20 % are tolerated), so the forces are not what was asked for; record a "
                  "gentler motion");
  }
}

void refuseMotionless(const mechanism::Robot& robot, const std::vector<Observation>& training,
                      const ObservationOptions& options) {
  const int axes = training.front().axes();
  for (int i = 0; i < axes; ++i) {
    double fastest = 0.0;
    bool moves = false;
    for (const Observation& o : training) {
      const double speed = o.signals.velocity_m_per_s.col(i).cwiseAbs().maxCoeff();
      fastest = std::max(fastest, speed);
      moves = moves || speed > movingLimits(robot, options, o.signals)[i];
    }
    if (moves) continue;
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    if (fastest < kNoMotion_m_per_s) {
      throw Refusal(whoIs(robot, i) + " does not move in " + namesOf(training) + "; record a motion of all of them");
    }
    if (!a.name.empty()) {
      throw Refusal("joint " + a.name + " does not move in " + namesOf(training) +
                    "; record a motion of all joints, or lock it in the robot file (locked_at_" +
                    mechanism::positionUnit(a) + ")");
    }
    throw Refusal("actuator " + std::to_string(i + 1) + " never moves faster than " + shortNumber(1e3 * fastest, 3) +
                  " mm/s in " + namesOf(training) + " (moving means more than " +
                  shortNumber(1e3 * options.moving_m_per_s, 3) + " mm/s); record a motion of all actuators");
  }
}

void refuseForceless(const mechanism::Robot& robot, const std::vector<Observation>& training,
                     const ObservationOptions& options) {
  for (const Observation& o : training) {
    const Eigen::VectorXd limits = movingLimits(robot, options, o.signals);
    for (int i = 0; i < o.axes(); ++i) {
      const auto force = o.row_force_N.col(i);
      const bool moves = o.signals.velocity_m_per_s.col(i).cwiseAbs().maxCoeff() > limits[i];
      if (!moves || force.maxCoeff() > force.minCoeff()) continue;
      throw Refusal(o.path + ": " + whoIs(robot, i) + " moves, but every row has the same force (" +
                    shortNumber(force[0], 4) + " " + o.force_unit[static_cast<std::size_t>(i)] +
                    "): its drive was off, or its command was not recorded; leave this recording out, or record anew");
    }
  }
}

void refuseTooShort(const std::vector<Observation>& training, const Equations& e, const ObservationOptions& options) {
  if (e.duration_s >= kShortestMotion_s && e.blocks >= 2) return;
  throw Refusal("only " + shortNumber(e.duration_s, 3) + " s of usable motion in " + namesOf(training) +
                " (all axes faster than " + shortNumber(1e3 * options.moving_m_per_s, 3) +
                " mm/s, no gap, singular pose or saturation); at least " + shortNumber(kShortestMotion_s) +
                " s are needed: record a longer motion" + leftOutOf(training));
}

}  // namespace knee_robot::identification
