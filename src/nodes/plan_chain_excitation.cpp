#include "plan_chain_excitation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/dynamics/chain_regressor.h"
#include "knee_robot/identification/motion_model.h"
#include "knee_robot/identification/observation.h"
#include "knee_robot/identification/recording_units.h"

namespace knee_robot::nodes {
namespace {

constexpr double kNoise = 0.02;       ///< of the largest torque that the URDF expects
constexpr double kLeastNoise = 1e-3;  ///< N m or N
constexpr int kPoses = 500;
constexpr double kApart_s = 1.0 / 6.0;  ///< between rows of a recording that count as independent

/// A share of what every joint must hold or throw, over poses and accelerations within the limits.
Eigen::VectorXd noiseOf(const mechanism::Robot& robot) {
  const Eigen::VectorXd inertia = dynamics::chainInertia(robot);
  dynamics::ChainRegressorData data(*robot.chain);
  Eigen::VectorXd most = Eigen::VectorXd::Constant(robot.axes(), kLeastNoise / kNoise);
  std::srand(1);
  for (int k = 0; k < kPoses; ++k) {
    Eigen::VectorXd q = Eigen::VectorXd::Random(robot.axes()), v = Eigen::VectorXd::Random(robot.axes()),
                    a = Eigen::VectorXd::Random(robot.axes());
    for (int i = 0; i < robot.axes(); ++i) {
      const mechanism::Actuator& joint = robot.actuators[static_cast<std::size_t>(i)];
      const double unit = joint.position_per_m();
      q[i] = unit * (joint.position_min_m + 0.5 * (1.0 + q[i]) * (joint.position_max_m - joint.position_min_m));
      v[i] *= 0.5 * unit * joint.velocity_max_m_per_s;
      a[i] *= 0.5 * unit * joint.acceleration_max_m_per_s2;
    }
    dynamics::chainRegressor(*robot.chain, robot.gravity, q, v, a, data);
    most = most.cwiseMax((data.regressor * inertia).cwiseAbs());
  }
  return kNoise * most;
}

/// What the recordings say already.
Eigen::MatrixXd informationOf(mechanism::Robot& robot, const std::vector<std::string>& files,
                              const excitation::ChainExcitationOptions& options) {
  Eigen::MatrixXd known;
  for (const recording::Recording& r : identification::loadRecordings(robot, files)) {
    const identification::Observation o =
        identification::observe(robot, identification::columnsOf(robot), r, identification::ObservationOptions());
    const int step = std::max(1, static_cast<int>(std::lround(kApart_s / o.signals.period_s)));
    std::vector<Eigen::Index> at;
    for (int n = 0; n < o.samples(); n += step) {
      if (o.usable[static_cast<std::size_t>(n)]) at.push_back(n);
    }
    Eigen::VectorXd unit(robot.axes());
    for (int i = 0; i < robot.axes(); ++i)
      unit[i] = robot.actuators[static_cast<std::size_t>(i)].position_per_m();
    const auto scaled = [&](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
      return m(at, Eigen::all) * unit.asDiagonal();
    };
    const Eigen::MatrixXd rows =
        excitation::chainInformation(robot, options, scaled(o.signals.position_m), scaled(o.signals.velocity_m_per_s),
                                     scaled(o.signals.acceleration_m_per_s2));
    if (known.size() == 0) known = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
    known += rows.transpose() * rows;
  }
  return known;
}

std::string table(const mechanism::Robot& robot, const excitation::ChainExcitationPlan& plan) {
  std::string out = "time_s";
  for (const char* signal : {"position", "velocity"}) {
    for (int i = 0; i < robot.axes(); ++i)
      out += std::string(",") + signal + "_" + std::to_string(i + 1) + "_" +
             mechanism::positionUnit(robot.actuators[static_cast<std::size_t>(i)]) + (signal[0] == 'v' ? "_per_s" : "");
  }
  out += "\n";
  for (Eigen::Index n = 0; n < plan.position.rows(); ++n) {
    out += shortNumber(plan.period_s * static_cast<double>(n), 9);
    for (const Eigen::MatrixXd* m : {&plan.position, &plan.velocity}) {
      for (Eigen::Index i = 0; i < m->cols(); ++i)
        out += "," + shortNumber((*m)(n, i), 9);
    }
    out += "\n";
  }
  return out;
}

}  // namespace

int planChainExcitation(mechanism::Robot robot, const std::vector<std::string>& recorded,
                        excitation::ChainExcitationOptions options, const std::string& output) {
  options.units = identification::motionModelOf(robot)->bodies().transform;
  options.noise = noiseOf(robot);
  if (!recorded.empty()) options.known = informationOf(robot, recorded, options);
  const excitation::ChainExcitationPlan plan = excitation::planChainExcitation(robot, options);
  writeFileAtomically(output, table(robot, plan));
  const int all = static_cast<int>(options.units.cols()) + 3 * robot.axes();
  std::printf("directions of %d that data decide rather than the prior: %d by what was recorded, %d with this motion\n",
              all, plan.decided_known, plan.decided);
  std::printf(
      "log determinant of the information: %.4g recorded, %.4g with the best random series, %.4g with this one "
      "(%d evaluations)\n",
      plan.information_known, plan.information_random, plan.information, plan.evaluations);
  std::printf("%-28s %20s %8s %10s %14s\n", "joint", "from, to (rad, m)", "range", "velocity", "acceleration");
  for (const excitation::JointUse& use : plan.joints)
    std::printf("%-28s %9.4f %10.4f %6.0f %% %8.0f %% %12.0f %%\n", use.name.c_str(), use.low, use.high,
                100.0 * use.range, 100.0 * use.velocity, 100.0 * use.acceleration);
  std::printf("written to %s; obstacles and self-collision are not known here\n", output.c_str());
  return 0;
}

}  // namespace knee_robot::nodes
