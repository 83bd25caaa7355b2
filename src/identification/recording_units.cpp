#include "knee_robot/identification/recording_units.h"

#include <algorithm>

#include "knee_robot/base/errors.h"

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

/// What a chain's joint has recorded, when the robot file says torque but only current is there, or the other way round.
void settle(mechanism::Actuator& a, int i, const recording::Recording& r) {
  const bool current = r.current_A.cols() > 0, effort = r.force_N.cols() > 0;
  if (a.recorded == Recorded::Current && !current)
    refuse(r, "column " + column("current", i, "A") + " is missing, though the robot file says that joint " + a.name +
                  " has its current recorded");
  if (a.recorded != Recorded::Current && !effort && current) a.recorded = Recorded::Current;
  if (a.recorded == Recorded::Current) return;
  const std::string want = mechanism::forceUnit(a);
  const char* const signal = a.recorded == Recorded::Torque ? "torque" : "force";
  if (!effort || r.force_unit[static_cast<std::size_t>(i)] != want)
    refuse(r, "column " + column(signal, i, want) + " is missing; joint " + a.name + " is " +
                  (a.revolute ? "revolute" : "prismatic"));
}

constexpr double kStands = 0.01;  ///< rad or m: a joint that goes less far in a whole recording stands still

/// Columns of joints that the robot file locks: of a recording with more columns than the chain has moving joints, those that stand
/// still are left out, if exactly the chain's are left then.
void leaveOutLocked(const mechanism::Robot& robot, recording::Recording& r) {
  if (!robot.chain || r.axes <= robot.axes()) return;
  std::vector<Eigen::Index> moving;
  for (int i = 0; i < r.axes; ++i) {
    if (r.position_m.col(i).maxCoeff() - r.position_m.col(i).minCoeff() > kStands) moving.push_back(i);
  }
  if (static_cast<int>(moving.size()) != robot.axes()) return;
  for (Eigen::MatrixXd* m : {&r.position_m, &r.reference_m, &r.velocity_m_per_s, &r.force_N, &r.current_A}) {
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
  r.notes.push_back("Columns of joints that stand still were left out: the robot file locks them.");
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
    return;
  }
  Eigen::MatrixXd force(r.rows(), r.axes);
  for (int i = 0; i < r.axes; ++i) {
    mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    settle(a, i, r);
    force.col(i) = (a.recorded == Recorded::Current ? r.current_A : r.force_N).col(i) / a.force_per_N();
    for (Eigen::MatrixXd* positions : {&r.position_m, &r.reference_m, &r.velocity_m_per_s}) {
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
  std::vector<recording::Recording> recordings;
  for (const std::string& file : files) {
    recordings.push_back(recording::loadRecording(file));
    toActuatorUnits(robot, recordings.back());
  }
  return recordings;
}

}  // namespace knee_robot::identification
