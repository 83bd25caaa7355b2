#include "knee_robot/identification/gain_verdicts.h"

#include "knee_robot/base/numbers.h"
#include "knee_robot/identification/drive_gains.h"

namespace knee_robot::identification {
namespace {

constexpr double kTenthKnown = 0.1;  ///< as for parameters: better known than that counts as identified

bool isEstimated(const mechanism::Actuator& a) {
  return a.recorded == mechanism::Recorded::Current && a.torque_per_ampere_std != 0.0;
}

bool isOpen(const mechanism::Actuator& a) {
  // one that is not known from zero is not known
  return !(a.torque_per_ampere > kGainInterval * a.torque_per_ampere_std);
}

}  // namespace

void judgeByGains(const mechanism::Robot& robot, dynamics::Model& model) {
  for (std::size_t i = 0; i < robot.actuators.size(); ++i) {
    const mechanism::Actuator& a = robot.actuators[i];
    if (!isEstimated(a) || a.torque_per_ampere_std < kTenthKnown * a.torque_per_ampere) continue;
    for (dynamics::ModelParameter& p : model.parameters) {
      for (const char* name : {"Fv_", "Fc_", "rotor_", "offset_"}) {
        if (p.name != name + std::to_string(i + 1)) continue;
        if (p.verdict != "identified" && p.verdict != "weakly identified") continue;
        p.verdict = isOpen(a) ? "in units of an unknown gain" : "weakly identified";
      }
    }
  }
}

std::vector<std::string> aboutGains(const mechanism::Robot& robot) {
  std::vector<std::string> sentences;
  for (const mechanism::Actuator& a : robot.actuators) {
    if (!isEstimated(a)) continue;
    const double error = kGainInterval * a.torque_per_ampere_std;
    sentences.push_back(
        "joint " + a.name + ": " +
        (isOpen(a)
             ? "these data do not determine the drive's gain; its friction and rotor inertia are in units of it. "
               "Give " +
                   std::string(a.revolute ? "torque_per_ampere_Nm" : "force_per_ampere_N") + " in the robot file."
             : shortNumber(a.torque_per_ampere, 4) + (a.revolute ? " N m/A" : " N/A") + ", 95 % interval " +
                   shortNumber(a.torque_per_ampere - error, 4) + " to " + shortNumber(a.torque_per_ampere + error, 4)));
  }
  if (!sentences.empty())
    sentences.push_back(
        "Estimated gains rest on the URDF's inertia: they are wrong by as much as its masses and centres are, and the "
        "intervals leave that out. drive_gains finds them from a payload of known mass.");
  return sentences;
}

}  // namespace knee_robot::identification
