#include "knee_robot/trajectory/reference_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "check_sentences.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "path_following.h"

namespace knee_robot::trajectory {
namespace {

constexpr double kLengthRounding = 1e-9;    ///< m: arithmetic, not measurement
constexpr double kRelativeRounding = 1e-9;  ///< of a limit
constexpr double kSamePose = 1e-4;  ///< m, rad: beyond it a followed pose is on another branch than the one asked for

/// Collects one quantity along the reference: its closest approach, and the first point beyond the limit.
class Watch {
 public:
  explicit Watch(Quantity quantity) { margin_.quantity = quantity; }

  void take(double value, double limit, double left, int line, int actuator) {
    Margin here{margin_.quantity, value, limit, line, actuator, left};
    if (!started_ || !(left >= margin_.left)) margin_ = here;
    started_ = true;
    if (!first_ && !(left >= -kRelativeRounding)) first_ = here;
  }
  /// A quantity that must stay below its limit.
  void takeBelow(double value, double limit, int line, int actuator) {
    take(value, limit, std::isinf(limit) ? 1.0 : 1.0 - value / limit, line, actuator);
  }

  bool started() const { return started_; }
  const Margin& margin() const { return margin_; }
  const std::optional<Margin>& first() const { return first_; }

 private:
  Margin margin_;
  std::optional<Margin> first_;
  bool started_ = false;
};

/// Everything that the checks share; `finish` turns watches into margins and the first violation.
struct CheckRun {
  const Reference& reference;
  const mechanism::Robot& robot;
  ReferenceCheck result;

  void close(const Watch& watch) {
    if (!watch.started()) return;
    result.margins.push_back(watch.margin());
    if (watch.first() && !result.violation) {
      result.violation = Violation{*watch.first(), violationSentence(*watch.first(), reference, robot)};
    }
  }
};

void checkLengths(CheckRun& run) {
  Watch shortest(Quantity::ShortestLength), longest(Quantity::LongestLength);
  for (Eigen::Index k = 0; k < run.result.lengths.rows(); ++k) {
    for (int i = 0; i < run.robot.axes(); ++i) {
      const mechanism::Actuator& actuator = run.robot.actuators[i];
      const double range = actuator.position_max_m - actuator.position_min_m;
      const double length = run.result.lengths(k, i);
      const int line = run.reference.lineOf(k);
      const auto left = [&](double distance) { return (distance + kLengthRounding) / range; };
      shortest.take(length, actuator.position_min_m, left(length - actuator.position_min_m), line, i + 1);
      longest.take(length, actuator.position_max_m, left(actuator.position_max_m - length), line, i + 1);
    }
  }
  // The earlier of the two is the one that the user meets first.
  const bool longest_first = longest.first() && (!shortest.first() || longest.first()->line < shortest.first()->line);
  run.close(longest_first ? longest : shortest);
  run.close(longest_first ? shortest : longest);
}

void checkDifferences(CheckRun& run) {
  const Points& q = run.result.lengths;
  const double period = run.reference.period_s;
  const Eigen::Index last = q.rows() - 1;
  Watch velocity(Quantity::Velocity), acceleration(Quantity::Acceleration);
  for (Eigen::Index k = 0; k <= last; ++k) {
    const Eigen::Index before = std::max<Eigen::Index>(k - 1, 0), after = std::min(k + 1, last);
    for (int i = 0; i < run.robot.axes(); ++i) {
      const mechanism::Actuator& actuator = run.robot.actuators[i];
      const int line = run.reference.lineOf(k);
      const double first = (q(k, i) - q(before, i)) / period;
      const double second = (q(after, i) - 2.0 * q(k, i) + q(before, i)) / (period * period);
      velocity.takeBelow(std::abs(first), actuator.velocity_max_m_per_s, line, i + 1);
      acceleration.takeBelow(std::abs(second), actuator.acceleration_max_m_per_s2, line, i + 1);
    }
  }
  run.close(velocity);
  run.close(acceleration);
}

struct PoseWatches {
  Watch base{Quantity::BaseAngle}, platform{Quantity::PlatformAngle}, condition{Quantity::Condition};

  void take(const mechanism::Robot& robot, const mechanism::Pose& pose, int line) {
    const mechanism::JointAngles angles = mechanism::jointAngles(*robot.mechanism, pose);
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const double limit = i < 3 ? robot.joints.universal_max : robot.joints.revolute_max;
      base.takeBelow(angles.base[i], limit, line, i + 1);
      if (i < 3) platform.takeBelow(angles.platform[i], robot.joints.spherical_max, line, i + 1);
    }
    condition.takeBelow(mechanism::conditionNumber(*robot.mechanism, pose), robot.singularity_condition_max, line, 0);
  }
};

/// The pose at the first point. A platform file says which of the assembly branches it means.
std::optional<mechanism::Pose> firstPose(const Reference& reference, const mechanism::Robot& robot,
                                         const mechanism::Lengths& lengths) {
  const mechanism::ForwardResult result =
      reference.space == Space::Platform
          ? mechanism::forwardKinematics(*robot.mechanism, lengths, reference.points.row(0).transpose())
          : mechanism::forwardKinematicsFromHome(*robot.mechanism, lengths);
  if (!result.ok()) return std::nullopt;
  return result.pose;
}

void checkPath(CheckRun& run) {
  const Points& q = run.result.lengths;
  const auto lostAt = [&](Eigen::Index point, double condition) {
    Watch assembly(Quantity::Assembly);
    assembly.take(condition, 1e6, -1.0, run.reference.lineOf(point), 0);
    run.close(assembly);
  };
  const std::optional<mechanism::Pose> first = firstPose(run.reference, run.robot, q.row(0).transpose());
  if (!first) return lostAt(0, std::numeric_limits<double>::infinity());

  PathFollower follower(*run.robot.mechanism, q.row(0).transpose(), *first);
  PoseWatches watches;
  Points poses(q.rows(), 4);
  poses.row(0) = first->transpose();
  watches.take(run.robot, *first, run.reference.lineOf(0));
  Eigen::Index lost = 0;
  for (Eigen::Index k = 1; k < q.rows() && lost == 0; ++k) {
    for (const double share : {0.5, 1.0}) {
      const mechanism::Lengths target = (1.0 - share) * q.row(k - 1).transpose() + share * q.row(k).transpose();
      if (!follower.moveTo(target)) {
        lost = k;
        break;
      }
      watches.take(run.robot, follower.pose(), run.reference.lineOf(k));
    }
    // At a fold the lengths turn back: they lead the robot back on its own branch, while the file goes on to the other
    // one.
    const bool folded =
        run.reference.space == Space::Platform &&
        !((follower.pose().transpose() - run.reference.points.row(k)).cwiseAbs().maxCoeff() < kSamePose);
    if (folded) lost = k;
    poses.row(k) = follower.pose().transpose();
  }
  run.close(watches.base);
  run.close(watches.platform);
  run.close(watches.condition);
  if (lost != 0) return lostAt(lost, mechanism::conditionNumber(*run.robot.mechanism, follower.pose()));
  run.result.poses = std::move(poses);
}

/// A robot and a reference that cannot be brought together at all.
void refuseMismatch(const Reference& reference, const mechanism::Robot& robot) {
  if (std::abs(reference.period_s - kStreamPeriod) > 1e-9) {
    throw InputError(reference.name + ": period_s is " + shortNumber(reference.period_s) +
                     ", but points are streamed every " + shortNumber(kStreamPeriod) +
                     " s; resample the reference to that period");
  }
  if (robot.kind == mechanism::MechanismKind::ThreeUpsOneRpu) return;
  if (reference.space == Space::Platform) {
    throw InputError(reference.name + ": holds platform coordinates, but " + robot.path +
                     " describes separate axes without a platform; use actuator or relative positions");
  }
  for (int i = robot.axes(); i < mechanism::kLegs; ++i) {
    for (Eigen::Index k = 0; k < reference.points.rows(); ++k) {
      if (reference.points(k, i) == 0.0) continue;
      throw InputError(reference.name + ":" + std::to_string(reference.lineOf(k)) + ": column " +
                       std::to_string(i + 1) + " is " + shortNumber(reference.points(k, i)) + ", but " + robot.path +
                       " has " + std::to_string(robot.axes()) + " axes; fill the columns beyond them with 0");
    }
  }
}

}  // namespace

mechanism::Lengths referenceLengths(const mechanism::Robot& robot, Space space, const mechanism::Vector4& point) {
  switch (space) {
    case Space::Actuator:
      return point;
    case Space::Platform:
      return mechanism::legLengths(*robot.mechanism, point);
    case Space::Relative:
      break;
  }
  mechanism::Lengths lengths = point;
  for (int i = 0; i < robot.axes(); ++i)
    lengths[i] += robot.actuators[i].home_length_m;
  return lengths;
}

ReferenceCheck checkReference(const Reference& reference, const mechanism::Robot& robot) {
  refuseMismatch(reference, robot);
  CheckRun run{reference, robot, {}};
  run.result.lengths.resize(reference.points.rows(), 4);
  for (Eigen::Index k = 0; k < reference.points.rows(); ++k) {
    run.result.lengths.row(k) =
        referenceLengths(robot, reference.space, reference.points.row(k).transpose()).transpose();
  }
  checkLengths(run);
  checkDifferences(run);
  // Beyond its lengths or with jumps a path is not worth following: what would be found there does not help to mend it.
  if (run.result.ok() && robot.kind == mechanism::MechanismKind::ThreeUpsOneRpu) checkPath(run);
  return std::move(run.result);
}

ReferenceCheck requirePlayable(const Reference& reference, const mechanism::Robot& robot) {
  ReferenceCheck check = checkReference(reference, robot);
  if (check.violation) throw InputError(check.violation->sentence);
  return check;
}

}  // namespace knee_robot::trajectory
