// tune_pid: gains of the Drivers from a recording of quick moves, with the margin that they keep over all poses.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/output_paths.h"
#include "knee_robot/control/axis_inertia.h"
#include "knee_robot/control/component_types.h"
#include "knee_robot/control/driver.h"
#include "knee_robot/report/page.h"
#include "knee_robot/report/report_folder.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "knee_robot/trajectory/reference_check.h"
#include "knee_robot/trajectory/reference_file.h"
#include "knee_robot/tuning/tuning_report.h"
#include "program.h"

using namespace knee_robot;

namespace {

constexpr double kCertain = 2.0;     // standard errors
constexpr double kKickShare = 0.06;  // of the force limit: what one encoder count may do
constexpr double kBandShare = 2.0;   // crossover beyond the low-pass of the recording's motion
constexpr double kLimitShare = 0.6;  // of velocity and acceleration limits that the reference uses
constexpr int kTimes = 10;           // moves to and fro of each axis
constexpr double kRest_s = 0.15;

struct Arguments {
  std::vector<std::string> movements;
  std::string robot, deployment, hardware, recording, output, reference;
  double payload_kg = 0.0, amplitude_m = 0.0015;
};

/// The Drivers as the deployment file makes them, and its servo period.
struct Deployed {
  std::vector<std::string> names;
  std::vector<control::PidGains> gains;
  double period_s = 0.001;
};

Deployed deployed(const Arguments& a, const mechanism::Robot& robot) {
  const auto image = std::make_unique<simulation::RobotImage>();
  const auto bus = simulation::openImageCards(*image);
  const control::HardwareFile hardware =
      a.hardware.empty() ? control::HardwareFile{} : control::loadHardwareFile(a.hardware);
  const rt::Deployment deployment(a.deployment, control::componentTypes(robot, hardware, *bus, {}),
                                  rt::Execution::Stepped);
  Deployed out;
  out.names.resize(robot.actuators.size());
  out.gains.resize(robot.actuators.size());
  for (const auto& component : deployment.components()) {
    const auto* driver = dynamic_cast<const control::Driver*>(component.get());
    if (driver == nullptr || driver->axis.value() > robot.axes()) continue;
    const auto i = static_cast<std::size_t>(driver->axis.value()) - 1;
    out.names[i] = driver->name();
    out.gains[i] = {driver->proportional, driver->integral, driver->derivative, driver->derivative_cutoff};
    out.period_s = rt::toSeconds(deployment.activityOf(*component)->options().period);
  }
  for (std::size_t i = 0; i < out.names.size(); ++i) {
    if (out.names[i].empty()) throw InputError(a.deployment + ": there is no Driver of axis " + std::to_string(i + 1));
  }
  return out;
}

/// Every hundredth of a second is more than inertia needs: ten a second.
std::vector<mechanism::Pose> posesOf(const std::vector<std::string>& movements, const mechanism::Robot& robot) {
  std::vector<mechanism::Pose> poses;
  for (const std::string& file : movements) {
    const trajectory::ReferenceCheck check =
        trajectory::requirePlayable(trajectory::readReference(file, std::nullopt), robot);
    for (Eigen::Index k = 0; k < check.poses.rows(); k += 10)
      poses.push_back(check.poses.row(k).transpose());
  }
  return poses;
}

/// Inertia over poses: what the recording measured at its own pose, changed by what the URDF says that other poses
/// change.
class MassRange {
 public:
  MassRange(const Arguments& a, const mechanism::Robot& robot, const identification::AxisResponses& responses) {
    if (!robot.mechanism || robot.urdf.empty()) return;
    const dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);
    mechanism::Lengths lengths;
    for (int i = 0; i < 4; ++i)
      lengths[i] = responses.axes[static_cast<std::size_t>(i)].position_mean_m;
    const mechanism::ForwardResult at = mechanism::forwardKinematicsFromHome(*robot.mechanism, lengths);
    if (!at.ok()) return;
    const control::AxisInertia here = control::axisInertia(robot, inertia, at.pose, 0.0);
    free_here_ = here.free();
    locked_here_ = here.locked();
    const double condition = mechanism::conditionNumber(*robot.mechanism, at.pose);
    std::vector<mechanism::Pose> poses = posesOf(a.movements, robot);
    where_ = poses.empty() ? " no nearer to a singularity" : " of the movements";
    if (poses.empty()) poses = control::posesWithin(robot, condition);
    const control::AxisInertiaRange empty = control::axisInertiaRange(robot, inertia, 0.0, poses);
    low_ = empty.low;
    high_ = a.payload_kg > 0.0 ? control::axisInertiaRange(robot, inertia, a.payload_kg, poses).high : empty.high;
    poses_ = empty.poses;
  }
  std::string apply(int i, const identification::AxisResponse& axis, double payload_kg,
                    tuning::PlantRange& range) const {
    const double spread = kCertain * axis.mass_std;
    if (poses_ == 0) {
      range.low.mass_kg = axis.mass_kg - spread;
      range.high.mass_kg = axis.mass_kg + spread + payload_kg;
      return "as measured, two standard errors";
    }
    // Motor and screw, which the URDF does not have, are the same at every pose: what was measured less what the URDF
    // has here, as if the other legs were locked or free, whichever makes the range wider.
    const double rotor_low = std::max(0.0, axis.mass_kg - spread - locked_here_[i]);
    const double rotor_high = std::max(rotor_low, axis.mass_kg + spread - free_here_[i]);
    range.low.mass_kg = std::min(axis.mass_kg - spread, rotor_low + low_[i]);
    range.high.mass_kg = std::max(axis.mass_kg + spread, rotor_high + high_[i]);
    return "measured " + shortNumber(axis.mass_kg, 3) + " kg at this pose, the rest by the URDF over " +
           std::to_string(poses_) + " poses" + where_ +
           (payload_kg > 0.0 ? " and up to " + shortNumber(payload_kg) + " kg" : "");
  }

 private:
  mechanism::Vector4 free_here_, locked_here_, low_, high_;
  int poses_ = 0;
  std::string where_;
};

void tune(const mechanism::Actuator& actuator, const tuning::TuningResults& results, tuning::TunedAxis& axis) {
  axis.present_worst = tuning::worstMargins(axis.present, axis.range, results.servo_period_s);
  tuning::GainBounds bounds{axis.highest_crossover_hz, actuator.metresPerCount(), kKickShare * actuator.forceLimit()};
  axis.present_kick_N = tuning::kickOfOneCount(axis.present, results.servo_period_s, bounds.count_m);
  axis.proposed = tuning::proposeGains(axis.range, results.servo_period_s, results.demand, bounds);
  if (!axis.proposed) return;
  axis.proposed_worst = tuning::worstMargins(*axis.proposed, axis.range, results.servo_period_s);
  axis.proposed_kick_N = tuning::kickOfOneCount(*axis.proposed, results.servo_period_s, bounds.count_m);
}

int propose(const Arguments& a, const mechanism::Robot& robot, const std::string& command_line) {
  report::Page("tune_pid");  // what the report needs and is missing is said before the work
  std::vector<std::string> read = a.movements;
  read.insert(read.end(), {a.recording, a.robot, robot.urdf, a.deployment, a.hardware});
  report::requireReportFolder({"tune_pid", a.output, read, {}});
  tuning::TuningResults results;
  results.recording = a.recording;
  results.deployment = a.deployment;
  const Deployed now = deployed(a, robot);
  results.servo_period_s = now.period_s;
  results.responses = identification::axisResponses(robot, recording::loadRecording(a.recording));
  const MassRange masses(a, robot, results.responses);
  int evaluated = 0;
  for (std::size_t i = 0; i < robot.actuators.size(); ++i) {
    const identification::AxisResponse& measured = results.responses.axes[i];
    tuning::TunedAxis axis;
    axis.name = (robot.mechanism ? "leg " : "axis ") + std::to_string(i + 1);
    axis.driver = now.names[i];
    axis.present = now.gains[i];
    axis.reason = results.responses.reasons[i];
    axis.highest_crossover_hz = kBandShare * measured.cutoff_hz;
    if (axis.reason.empty()) {
      ++evaluated;
      axis.range_source = masses.apply(static_cast<int>(i), measured, a.payload_kg, axis.range);
      axis.range.low.viscous_N_s_per_m = std::max(0.0, measured.viscous_N_s_per_m - kCertain * measured.viscous_std);
      axis.range.high.viscous_N_s_per_m = std::max(0.0, measured.viscous_N_s_per_m + kCertain * measured.viscous_std);
      axis.range.low.delay_s = std::max(0.0, measured.delay_s - kCertain * measured.delay_std);
      axis.range.high.delay_s = std::max(axis.range.low.delay_s, measured.delay_s + kCertain * measured.delay_std);
      // A negative one says by how much friction can pass for delay.
      axis.range.high.delay_s = std::max(axis.range.high.delay_s, -measured.delay_s);
      tune(robot.actuators[i], results, axis);
    }
    results.axes.push_back(axis);
  }
  if (evaluated == 0) throw Refusal(a.recording + ": no axis can be judged; the first: " + results.axes.front().reason);
  std::cout << tuning::tuningSummary(results);
  tuning::writeTuning(results, command_line, a.output);
  std::cout << "written: " << a.output << "/report.html, report.json, gains.yaml" << std::endl;
  return kExitDone;
}

double smooth(double x) {
  return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}

/// Each axis to and fro, one after the other, as quick as its limits allow with room.
int writeReference(const Arguments& a, const mechanism::Robot& robot) {
  requireWritable(a.reference);
  requireNoneOverwritten({a.robot, robot.urdf}, {a.reference});
  std::ostringstream text;
  text << "# space: relative\n# quick moves of " << shortNumber(1e3 * a.amplitude_m)
       << " mm, one axis after the other, for tune_pid\n";
  std::size_t points = 0;
  const auto point = [&](std::size_t axis, double value) {
    for (std::size_t i = 0; i < robot.actuators.size(); ++i)
      text << (i > 0 ? " " : "") << exactNumber(i == axis ? value : 0.0);
    text << '\n';
    ++points;
  };
  point(0, 0.0);
  for (std::size_t axis = 0; axis < robot.actuators.size(); ++axis) {
    const mechanism::Actuator& actuator = robot.actuators[axis];
    const double way = 2.0 * a.amplitude_m;  // the longest move, from end to end
    const double time = std::max(std::sqrt(5.774 * way / (kLimitShare * actuator.acceleration_max_m_per_s2)),
                                 1.875 * way / (kLimitShare * actuator.velocity_max_m_per_s));
    const int steps = std::max(4, static_cast<int>(std::ceil(time / trajectory::kStreamPeriod)));
    const int rest = static_cast<int>(kRest_s / trajectory::kStreamPeriod);
    double from = 0.0;
    for (int move = 0; move <= 2 * kTimes; ++move) {
      const double to = move == 2 * kTimes ? 0.0 : (move % 2 == 0 ? a.amplitude_m : -a.amplitude_m);
      for (int k = 1; k <= steps; ++k)
        point(axis, from + (to - from) * smooth(static_cast<double>(k) / steps));
      for (int k = 0; k < rest; ++k)
        point(axis, to);
      from = to;
    }
  }
  writeFileAtomically(a.reference, text.str());
  std::cout << "written: " << a.reference << ", " << points
            << " points; look at it with check_reference, play and record it without anybody on the robot" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app(
      "Proposes gains for the Drivers from a recording of quick moves, and shows the margin of present and proposed "
      "gains over "
      "all poses. First: --write-reference FILE, play and record it.",
      "tune_pid");
  Arguments a;
  app.option("RECORDING", a.recording, "recording of quick moves, one axis after the other");
  app.option("--robot", a.robot, "robot file").required();
  app.option("--deployment", a.deployment, "deployment file with the present gains");
  app.option("--hardware", a.hardware, "hardware file");
  app.option("--payload-kg", a.payload_kg, "heaviest load on the platform for which the margins have to hold (0)")
      .within(0.0, 200.0);
  app.option("--movement", a.movements,
             "reference files whose poses count; default: all poses no nearer to a singularity than "
             "the recording");
  app.option("--output", a.output, "folder for report.html, report.json and gains.yaml");
  app.option("--write-reference", a.reference, "only write a reference file of quick moves, to be played and recorded");
  app.option("--amplitude-m", a.amplitude_m, "amplitude of the moves of --write-reference (0.0015)").within(1e-4, 0.05);
  return nodes::runProgram(app, argc, argv, [&] {
    const mechanism::Robot robot = mechanism::loadRobot(a.robot);
    if (!a.reference.empty()) return writeReference(a, robot);
    if (a.recording.empty() || a.deployment.empty() || a.output.empty())
      throw InputError("tune_pid needs RECORDING, --deployment and --output, or --write-reference; see --help");
    return propose(a, robot, nodes::commandLine("tune_pid", argc, argv));
  });
}
