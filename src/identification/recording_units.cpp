#include "knee_robot/identification/recording_units.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::identification {
namespace {

using mechanism::Recorded;

[[noreturn]] void refuse(const recording::Recording& r, const std::string& sentence) {
  throw InputError(r.path + ":1: " + sentence);
}

std::string column(const char* signal, int axis, const std::string& unit) {
  return std::string(signal) + "_" + std::to_string(axis + 1) + "_" + unit;
}

void requirePositions(const mechanism::Robot& robot, const recording::Recording& r) {
  for (int i = 0; i < r.axes; ++i) {
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    const std::string have = r.position_unit[static_cast<std::size_t>(i)], want = mechanism::positionUnit(a);
    if (have == want) continue;
    const std::string whose = a.name.empty() ? "actuator " + std::to_string(i + 1) : "joint " + a.name;
    refuse(r, "column " + column("position", i, have) + " where " + whose + " of " + robot.path + " needs " +
                  column("position", i, want));
  }
}

/// What a chain's joint has recorded, when the robot file says torque but only current is there, or the other way
/// round.
void settle(mechanism::Actuator& a, int i, const recording::Recording& r) {
  const bool current = r.current_A.cols() > 0, effort = r.force_N.cols() > 0;
  if (a.recorded == Recorded::Current && !current)
    refuse(r, "column " + column("current", i, "A") + " is missing; joint " + a.name +
                  " counts in amperes, as the robot file, the model or the recordings before this one say");
  if (a.recorded != Recorded::Current && !effort && current) a.recorded = Recorded::Current;
  if (a.recorded == Recorded::Current) return;
  const std::string want = mechanism::forceUnit(a);
  const char* const signal = a.recorded == Recorded::Torque ? "torque" : "force";
  if (!effort || r.force_unit[static_cast<std::size_t>(i)] != want)
    refuse(r, "column " + column(signal, i, want) + " is missing; joint " + a.name + " is " +
                  (a.revolute ? "revolute" : "prismatic"));
}

constexpr double kSlowestRow_s = 0.9;  ///< rows further apart follow no motion; 1 kHz in milliseconds is 1

/// A chain's own travel sets what counts as moving, so that a slow clock would go through every fit.
void refuseMilliseconds(const recording::Recording& r) {
  if (r.rows() < 2) return;
  const double each = (r.time_s.back() - r.time_s.front()) / static_cast<double>(r.rows() - 1);
  if (each < kSlowestRow_s) return;
  refuse(r, "column time_s: a row comes every " + shortNumber(each, 3) +
                " s, too slow to follow a motion; are these milliseconds? Convert them (import_recording --column "
                "time=time_s,ms), or record at 10 Hz or more");
}

/// Positions in millimetres would go through a bench's fit; a parallel robot's pose would not be found.
void refuseFarOutside(const mechanism::Robot& robot, const recording::Recording& r) {
  for (int i = 0; i < r.axes; ++i) {
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    const double low = r.position_m.col(i).minCoeff(), high = r.position_m.col(i).maxCoeff();
    const double travel = a.position_max_m - a.position_min_m;  // a home elsewhere shifts positions by that at most
    if (!(travel > 0.0)) continue;
    if (low >= a.position_min_m - travel && high <= a.position_max_m + travel) continue;
    const bool above = high > a.position_max_m + travel;
    refuse(r, "column " + column("position", i, "m") + ": " + shortNumber(above ? high : low, 4) + " m is outside " +
                  (above ? "position_max_m " + shortNumber(a.position_max_m)
                         : "position_min_m " + shortNumber(a.position_min_m)) +
                  " of actuator " + std::to_string(i + 1) +
                  ": millimetres? Convert them (import_recording --column ...,mm), or correct the robot file");
  }
}

constexpr double kStands = 0.01;  ///< rad or m: a joint that goes less far in a whole recording stands still
constexpr double kTurn = kTwoPi;
constexpr double kBeyondLimits = kTurn;  ///< rad by which no recording leaves a bounded joint's limits

/// Columns of joints that are locked: of a recording with more columns than the chain has moving joints, those that
/// stand still are left out, if exactly the chain's are left then.
void leaveOutLocked(const mechanism::Robot& robot, recording::Recording& r) {
  if (!robot.chain || r.axes <= robot.axes()) return;
  std::vector<Eigen::Index> moving;
  std::string names;
  for (int i = 0; i < r.axes; ++i) {
    if (r.position_m.col(i).maxCoeff() - r.position_m.col(i).minCoeff() <= kStands) continue;
    moving.push_back(i);
    names += (names.empty() ? "" : ", ") + std::to_string(i + 1);
  }
  if (static_cast<int>(moving.size()) != robot.axes()) {
    refuse(r, "records " + std::to_string(r.axes) + " joints, of which " + std::to_string(moving.size()) + " move (" +
                  names + "), but the chain of " + robot.path + " has " + std::to_string(robot.axes()) +
                  " that move (named there, or those that move in the training recordings); list the recorded joints");
  }
  for (Eigen::MatrixXd* m : {&r.position_m, &r.reference_m, &r.velocity_m_per_s, &r.force_N, &r.current_A, &r.motor_m,
                             &r.temperature_degC}) {
    if (m->cols() == r.axes) *m = (*m)(Eigen::all, moving).eval();
  }
  for (std::vector<std::string>* units : {&r.position_unit, &r.force_unit}) {
    std::vector<std::string> kept;
    for (const Eigen::Index i : moving) {
      if (units->size() == static_cast<std::size_t>(r.axes)) kept.push_back((*units)[static_cast<std::size_t>(i)]);
    }
    *units = kept;
  }
  r.axes = robot.axes();
  r.notes.push_back("Columns of joints that stand still were left out: they are locked.");
}

/// Encoders of joints that turn on and on are often recorded within one turn.
void followOverTurns(const mechanism::Robot& robot, recording::Recording& r) {
  std::string names;
  for (int i = 0; i < r.axes; ++i) {
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    if (!a.revolute) continue;
    double turns = 0.0;
    bool any = false;
    for (Eigen::Index k = 1; k < r.position_m.rows(); ++k) {
      const double step = r.position_m(k, i) + turns - r.position_m(k - 1, i);
      if (std::abs(step) > 0.5 * kTurn) turns -= kTurn * std::round(step / kTurn);
      any = any || turns != 0.0;
      r.position_m(k, i) += turns;
    }
    if (!any) continue;
    names += (names.empty() ? "" : ", ") + a.name;
    for (Eigen::MatrixXd* other : {&r.reference_m, &r.motor_m}) {
      if (other->cols() == 0) continue;
      const Eigen::ArrayXd ahead = (other->col(i) - r.position_m.col(i)).array() / kTurn;
      other->col(i).array() -= kTurn * ahead.round();
    }
  }
  if (!names.empty())
    r.notes.push_back("Positions jump by whole turns and were followed over the jumps: " + names + ".");
}

/// Degrees in a column of radians would go through every fit.
void refuseDegrees(const mechanism::Robot& robot, const recording::Recording& r) {
  for (int i = 0; i < r.axes; ++i) {
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    if (!a.revolute || !robot.chain->joints[static_cast<std::size_t>(i)].bounded) continue;
    const double low = r.position_m.col(i).minCoeff(), high = r.position_m.col(i).maxCoeff();
    const double least = a.position_min_m * a.position_per_m(), most = a.position_max_m * a.position_per_m();
    if (low > least - kBeyondLimits && high < most + kBeyondLimits) continue;
    refuse(r, column("position", i, "rad") + " goes from " + shortNumber(low, 4) + " to " + shortNumber(high, 4) +
                  ", but joint " + a.name + " is limited to " + shortNumber(least, 4) + " to " + shortNumber(most, 4) +
                  " rad; are these degrees? Convert them, or correct position_min_rad and position_max_rad");
  }
}

}  // namespace

void toActuatorUnits(mechanism::Robot& robot, recording::Recording& r) {
  leaveOutLocked(robot, r);
  recording::requireAxes(r, robot.axes(), robot.path);
  requirePositions(robot, r);
  if (robot.kind != mechanism::MechanismKind::Chain) {
    for (int i = 0; i < static_cast<int>(r.force_unit.size()); ++i) {
      if (r.force_unit[static_cast<std::size_t>(i)] != "N")
        refuse(r, "column " + column("torque", i, "Nm") + " where " + robot.path + " needs " + column("force", i, "N"));
    }
    if (robot.kind == mechanism::MechanismKind::Axes) refuseFarOutside(robot, r);
    return;
  }
  refuseMilliseconds(r);
  refuseDegrees(robot, r);
  followOverTurns(robot, r);
  Eigen::MatrixXd force(r.rows(), r.axes);
  for (int i = 0; i < r.axes; ++i) {
    mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    settle(a, i, r);
    force.col(i) = (a.recorded == Recorded::Current ? r.current_A : r.force_N).col(i) / a.force_per_N();
    for (Eigen::MatrixXd* positions : {&r.position_m, &r.reference_m, &r.velocity_m_per_s, &r.motor_m}) {
      if (positions->cols() > 0) positions->col(i) /= a.position_per_m();
    }
  }
  r.force_N = force;
  r.command_V.resize(r.rows(), 0);
  r.force_is_measured = true;
}

void takeGains(const dynamics::Model& model, mechanism::Robot& robot) {
  for (std::size_t i = 0; i < std::min(model.joints.size(), robot.actuators.size()); ++i) {
    mechanism::Actuator& a = robot.actuators[i];
    if (a.torque_per_ampere > 0.0 || !(model.joints[i].torque_per_ampere > 0.0)) continue;
    a.torque_per_ampere = model.joints[i].torque_per_ampere;
    a.torque_per_ampere_std = model.joints[i].torque_per_ampere_std;
    a.recorded = Recorded::Current;
  }
}

std::vector<recording::Recording> loadRecordings(mechanism::Robot& robot, const std::vector<std::string>& files) {
  std::vector<recording::Recording> recordings = readRecordings(files);
  for (recording::Recording& r : recordings)
    toActuatorUnits(robot, r);
  return recordings;
}

}  // namespace knee_robot::identification
