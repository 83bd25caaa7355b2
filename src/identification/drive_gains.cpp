#include "knee_robot/identification/drive_gains.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/motion_model.h"
#include "masking.h"

namespace knee_robot::identification {
namespace {

constexpr double kSmooth_m_per_s = 2e-3;  ///< of Coulomb friction while nothing better is known
constexpr double kByPayload = 1e-3;  ///< pull towards the URDF: keeps directions that no data decide where they are
constexpr double kByUrdf = 10.0;
constexpr int kMostIterations = 60;
constexpr double kConverged = 1e-5;
constexpr double kFelt = 5.0;  ///< standard errors of a gain below which the payload does not tell it

constexpr double kClearlyBetter = 0.99;  ///< share of the cost: less of a change is noise
/// Times the present gain, and its inverse: no drive has more or less. The joint's motion needs no torque, or all of it
/// goes into friction, and no sign is told.
constexpr double kNoDrive = 1e4;
constexpr double kUnlikely = 2.0;  ///< times the URDF's weight: less than kg for pounds; URDFs of real arms are better
constexpr double kImpossible = 4.0;  ///< the same: no URDF is that wrong, but a unit is
constexpr double kPoor = 50.0;       ///< percent of the current's rms: a quarter of its power is not explained

constexpr int kBody = dynamics::kLinkParameters;

/// Both sets of recordings as equations, the currents' noise alike on every joint.
struct Problem {
  Equations e;
  std::vector<char> is_loaded;  ///< per row
  Eigen::MatrixXd units;        ///< rigid columns x unit coordinates
  Eigen::VectorXd prior;
  int rigid = 0, own = 0;  ///< columns
  double mass = 0.0, pull = 0.0;
  bool with_payload = false;

  int gains() const { return e.axes; }
  int payload() const { return with_payload ? kBody - 1 : 0; }
  int size() const { return static_cast<int>(units.cols()) + payload() + own + gains(); }
};

/// Unit coordinates of the bodies, payload without its mass, own columns, inverse gains.
struct Unknowns {
  Eigen::VectorXd u, payload, own, inverse;
};

Unknowns taken(const Problem& p, const Eigen::VectorXd& z) {
  const Eigen::Index n = p.units.cols();
  return {z.head(n), z.segment(n, p.payload()), z.segment(n + p.payload(), p.own), z.tail(p.gains())};
}

/// Rigid torque of every row with gains of one.
Eigen::VectorXd rigidPart(const Problem& p, const Unknowns& x) {
  Eigen::VectorXd bodies = p.e.a.leftCols(p.rigid) * (p.prior + p.units * x.u);
  if (!p.with_payload) return bodies;
  Eigen::VectorXd parameters(kBody);
  parameters << x.payload, p.mass;
  const Eigen::VectorXd load = p.e.a.middleCols(p.rigid - kBody, kBody) * parameters;
  for (int row = 0; row < p.e.rows(); ++row)
    bodies[row] += p.is_loaded[static_cast<std::size_t>(row)] ? load[row] : 0.0;
  return bodies;
}

double presentGain(const mechanism::Actuator& a) {
  return a.torque_per_ampere > 0.0 ? a.torque_per_ampere : 1.0;
}

/// One step of Gauss and Newton without block `out`; true when it was small.
bool step(const Problem& p, int out, Eigen::VectorXd& z) {
  const Unknowns x = taken(p, z);
  const Eigen::VectorXd torque = rigidPart(p, x);
  const Eigen::Index n = p.units.cols(), load = p.payload();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(p.e.rows(), p.size());
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(p.e.rows());
  const Eigen::MatrixXd by_unit = p.e.a.leftCols(p.rigid) * p.units;
  for (int row = 0; row < p.e.rows(); ++row) {
    const std::size_t at = static_cast<std::size_t>(row);
    if (p.e.block[at] == out) continue;
    const int i = p.e.actuator[at];
    jacobian.row(row).head(n) = x.inverse[i] * by_unit.row(row);
    if (load > 0 && p.is_loaded[at])
      jacobian.row(row).segment(n, load) = x.inverse[i] * p.e.a.row(row).segment(p.rigid - kBody, load);
    jacobian.row(row).segment(n + load, p.own) = p.e.a.row(row).tail(p.own);
    jacobian(row, n + load + p.own + i) = torque[row];
    residual[row] = p.e.b[row] - x.inverse[i] * torque[row] - p.e.a.row(row).tail(p.own).dot(x.own);
  }
  Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  Eigen::VectorXd right = jacobian.transpose() * residual;
  normal.diagonal().head(n).array() += p.pull;
  right.head(n) -= p.pull * x.u;
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseMax(1e-12);
  normal = scale.cwiseInverse().asDiagonal() * normal * scale.cwiseInverse().asDiagonal();
  normal.diagonal().array() += 1e-10;
  const Eigen::VectorXd change = normal.ldlt().solve(right.cwiseQuotient(scale)).cwiseQuotient(scale);
  const double most =
      (change.tail(p.gains()).cwiseAbs().cwiseQuotient(x.inverse.cwiseAbs().cwiseMax(1e-12))).maxCoeff();
  z += std::min(1.0, 0.5 / std::max(most, 1e-12)) * change;  // no gain changes by more than half at once
  return most < kConverged;
}

int solve(const Problem& p, int out, Eigen::VectorXd& z) {
  for (int k = 1; k <= kMostIterations; ++k) {
    if (step(p, out, z)) return k;
  }
  return kMostIterations;
}

Eigen::VectorXd residualOf(const Problem& p, const Eigen::VectorXd& z) {
  const Unknowns x = taken(p, z);
  const Eigen::VectorXd torque = rigidPart(p, x);
  Eigen::VectorXd residual = p.e.b - p.e.a.rightCols(p.own) * x.own;
  for (int row = 0; row < p.e.rows(); ++row)
    residual[row] -= x.inverse[p.e.actuator[static_cast<std::size_t>(row)]] * torque[row];
  return residual;
}

double costOf(const Problem& p, const Eigen::VectorXd& z) {
  return residualOf(p, z).squaredNorm() + p.pull * taken(p, z).u.squaredNorm();
}

std::vector<Eigen::Index> rowsOf(const Problem& p, int joint) {
  std::vector<Eigen::Index> rows;
  for (int row = 0; row < p.e.rows(); ++row) {
    if (p.e.actuator[static_cast<std::size_t>(row)] == joint) rows.push_back(row);
  }
  return rows;
}

/// Where Gauss and Newton begin, and what lets its gains be positive only.
struct Start {
  Eigen::VectorXd z;         ///< all gains positive
  Eigen::VectorXd measured;  ///< inverse gains as the currents say
};

/// Inverse gains by the URDF's torques, joint by joint.
Start start(const Problem& p) {
  Start out{Eigen::VectorXd::Zero(p.size()), Eigen::VectorXd(p.gains())};
  const Eigen::VectorXd torque = rigidPart(p, taken(p, out.z));
  for (int i = 0; i < p.gains(); ++i) {
    const std::vector<Eigen::Index> rows = rowsOf(p, i);
    Eigen::MatrixXd x(static_cast<Eigen::Index>(rows.size()), p.own + 1);
    x << p.e.a(rows, Eigen::all).rightCols(p.own), torque(rows);
    const Eigen::VectorXd fit = x.completeOrthogonalDecomposition().solve(Eigen::VectorXd(p.e.b(rows)));
    out.measured[i] = fit[p.own];
    out.z[p.size() - p.gains() + i] =
        std::max(fit[p.own], 1e-3 * p.e.b(rows).norm() / std::max(1e-9, torque(rows).norm()));
    out.z.segment(p.units.cols() + p.payload(), p.own) += fit.head(p.own);
  }
  return out;
}

/// An inverse gain that a drive may have, whatever its sign.
bool isDrives(double inverse) {
  return std::abs(inverse) < kNoDrive && std::abs(inverse) > 1.0 / kNoDrive;
}

/// Fits with positive gains; then lets those that began negative be so, one after the other, where that fits better.
/// Steps never take a gain through zero, so that its sign is the start's.
int solveWithSigns(const Problem& p, Eigen::VectorXd& z) {
  const Start from = start(p);
  z = from.z;
  const int iterations = solve(p, -1, z);
  Eigen::VectorXd begin = from.z;
  for (int i = 0; i < p.gains(); ++i) {
    if (from.measured[i] >= 0.0) continue;
    Eigen::VectorXd other = begin;
    other[p.size() - p.gains() + i] = from.measured[i];
    const Eigen::VectorXd other_begin = other;
    solve(p, -1, other);
    if (!isDrives(other[p.size() - p.gains() + i]) || !(costOf(p, other) < kClearlyBetter * costOf(p, z))) continue;
    z = other;
    begin = other_begin;
  }
  for (int i = p.size() - p.gains(); i < p.size(); ++i)
    z[i] = isDrives(z[i]) ? z[i] : from.z[i];
  return iterations;
}

/// A current that goes against the torque is a column's wrong sign, which would spoil the other gains, too.
void refuseNegative(const mechanism::Robot& robot, const Problem& p, const Eigen::VectorXd& z) {
  std::string joints, columns;
  int count = 0;
  for (int i = 0; i < p.gains(); ++i) {
    const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
    const double gain = presentGain(a) / z[p.size() - p.gains() + i];
    if (gain > 0.0) continue;
    ++count;
    joints += (joints.empty() ? "" : ", ") + a.name + " (" + shortNumber(gain, 3) + (a.revolute ? " N m/A)" : " N/A)");
    columns += (columns.empty() ? "" : ", ") + ("current_" + std::to_string(i + 1) + "_A");
  }
  if (count == 0) return;
  throw Refusal(std::string(count == 1 ? "joint " : "joints ") + joints +
                (count == 1 ? ": the gain comes out negative" : ": the gains come out negative") +
                "; check the sign of " + columns);
}

Problem problemOf(const mechanism::Robot& robot, const std::vector<Column>& columns,
                  const std::vector<Observation>& unloaded, const std::vector<Observation>& loaded, double payload_kg,
                  const ObservationOptions& options) {
  std::vector<Observation> all = unloaded;
  all.insert(all.end(), loaded.begin(), loaded.end());
  const std::vector<dynamics::FrictionLaw> laws(all.front().regressor.size(), dynamics::smoothLaw(kSmooth_m_per_s));
  for (Observation& o : all)
    setFriction(o, columns, laws);
  Problem p;
  p.e = stackEquations(all, options);
  if (p.e.rows() == 0 || p.e.blocks < 3) throw Refusal("too little motion to tell drive gains; record a longer one");
  weightRows(p.e, rmsPerActuator(p.e, p.e.b));
  for (const std::size_t file : p.e.file)
    p.is_loaded.push_back(file >= unloaded.size());
  const PhysicalCoordinates bodies = motionModelOf(robot)->bodies();
  p.prior = bodies.prior;
  p.units = bodies.transform;
  p.rigid = static_cast<int>(bodies.prior.size());
  p.own = static_cast<int>(columns.size()) - p.rigid;
  p.with_payload = !loaded.empty();
  p.mass = payload_kg;
  p.pull = p.with_payload ? kByPayload : kByUrdf;
  return p;
}

Eigen::VectorXd percentOf(const Problem& p, const Eigen::VectorXd& z) {
  return 100.0 * rmsPerActuator(p.e, residualOf(p, z)).cwiseQuotient(rmsPerActuator(p.e, p.e.b));
}

/// Rows of one joint, of its regressor's own columns taken off what they can stand for.
Eigen::VectorXd besideOwn(const Problem& p, const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& torque) {
  const Eigen::MatrixXd own = p.e.a(rows, Eigen::all).rightCols(p.own);
  const Eigen::VectorXd at = torque(rows);
  return at - own * own.completeOrthogonalDecomposition().solve(at);
}

/// How many times what the URDF's inertia asks for the fitted bodies' torques are; without what a rotor may stand for.
double armByUrdf(const Problem& p, const Eigen::VectorXd& z) {
  const Eigen::VectorXd by_urdf = p.e.a.leftCols(p.rigid) * p.prior;
  const Eigen::VectorXd change = p.e.a.leftCols(p.rigid) * (p.units * taken(p, z).u);
  double more = 0.0, squares = 1e-12;
  for (int i = 0; i < p.gains(); ++i) {
    const Eigen::VectorXd torque = besideOwn(p, rowsOf(p, i), by_urdf);
    more += torque.dot(besideOwn(p, rowsOf(p, i), change));
    squares += torque.squaredNorm();
  }
  return 1.0 + more / squares;
}

/// The payload's mass is the scale of everything: with a wrong one the arm itself would be too heavy or too light.
/// Without a payload in the difference of the recordings the gains grow until the arm could carry it unnoticed.
void judgeMass(double payload_kg, double times, DriveGains& out) {
  const std::string arm = "with a payload of " + shortNumber(payload_kg) + " kg the arm itself weighs " +
                          shortNumber(times, 3) + " times what its URDF says; ";
  if (!(times < kImpossible && times > 1.0 / kImpossible)) {
    throw Refusal(arm +
                  "is the mass in kg, and is the payload fixed to the last link in all loaded recordings and in no "
                  "other one?");
  }
  if (!(times < kUnlikely && times > 1.0 / kUnlikely)) out.notes.push_back(arm + "check the mass.");
}

void judgeGains(const mechanism::Robot& robot, DriveGains& out) {
  for (int i = 0; i < robot.axes(); ++i) {
    const std::string joint = "joint " + robot.actuators[static_cast<std::size_t>(i)].name + ": ";
    if (!(out.gain[i] > kGainInterval * out.std[i])) {
      throw Refusal(joint + "the gain may be anything, zero included (" + shortNumber(out.gain[i], 3) +
                    " with a standard error of " + shortNumber(out.std[i], 2) +
                    "); record a motion in which its drive has more to carry, or lock it in the robot file");
    }
    if (!(out.percent[i] < kPoor)) {
      out.notes.push_back(joint + "the error is " + shortNumber(out.percent[i], 3) +
                          " % of the current's rms; do not trust its gain.");
    }
  }
}

/// Gains and the payload's centre, with standard errors by leaving blocks out in turn.
void estimate(const mechanism::Robot& robot, const Problem& p, const Eigen::VectorXd& z, DriveGains& out) {
  Eigen::MatrixXd left_out(p.size(), p.e.blocks);
  for (int block = 0; block < p.e.blocks; ++block) {
    Eigen::VectorXd own = z;
    solve(p, block, own);
    left_out.col(block) = own;
  }
  const double factor = (p.e.blocks - 1.0) / p.e.blocks;
  const auto stdOf = [&](const Eigen::ArrayXd& v) { return std::sqrt(factor * (v - v.mean()).square().sum()); };
  const int n = p.gains();
  out.gain.resize(n);
  out.std.resize(n);
  for (int i = 0; i < n; ++i) {
    const double present = presentGain(robot.actuators[static_cast<std::size_t>(i)]);
    out.gain[i] = present / z[p.size() - n + i];
    out.std[i] = stdOf(present * left_out.row(p.size() - n + i).array().inverse());
  }
  for (int k = 0; p.with_payload && k < 3; ++k) {
    const Eigen::Index at = p.units.cols() + 6 + k;
    out.center_m[k] = z[at] / p.mass;
    out.center_std_m[k] = stdOf(left_out.row(at).array() / p.mass);
  }
}

void refuseUnmoved(const mechanism::Robot& robot, const std::vector<Observation>& all,
                   const ObservationOptions& options) {
  for (int i = 0; i < robot.axes(); ++i) {
    const bool moves = std::any_of(all.begin(), all.end(), [&](const Observation& o) {
      return o.signals.velocity_m_per_s.col(i).cwiseAbs().maxCoeff() > movingLimits(robot, options, o.signals)[i];
    });
    if (moves) continue;
    throw Refusal("joint " + robot.actuators[static_cast<std::size_t>(i)].name +
                  " never moves, so that its current says nothing of its gain; record a motion of all joints, or lock "
                  "it in the robot file");
  }
}

}  // namespace

DriveGains driveGains(const mechanism::Robot& robot, const std::vector<Observation>& unloaded,
                      const std::vector<Observation>& loaded, double payload_kg, const ObservationOptions& options) {
  refuseUnmoved(robot, unloaded, options);
  const Problem p = problemOf(robot, columnsOf(robot), unloaded, loaded, payload_kg, options);
  Eigen::VectorXd z;
  DriveGains out;
  out.iterations = solveWithSigns(p, z);
  refuseNegative(robot, p, z);
  if (p.with_payload) judgeMass(payload_kg, armByUrdf(p, z), out);
  estimate(robot, p, z, out);
  out.payload_kg = payload_kg;
  out.percent = percentOf(p, z);
  if (p.with_payload && !(out.gain.array() > kFelt * out.std.array()).any()) {
    throw Refusal("no joint feels the payload of " + shortNumber(payload_kg) +
                  " kg well enough to tell its gain; record with a heavier one, or where it is lifted");
  }
  if (p.with_payload) judgeGains(robot, out);
  return out;
}

bool gainsByUrdf(mechanism::Robot& robot, const std::vector<Observation>& training, const ObservationOptions& options) {
  const auto open = [](const mechanism::Actuator& a) {
    return a.recorded == mechanism::Recorded::Current && !(a.torque_per_ampere > 0.0);
  };
  if (std::none_of(robot.actuators.begin(), robot.actuators.end(), open)) return false;
  const DriveGains found = driveGains(robot, training, {}, 0.0, options);
  for (std::size_t i = 0; i < robot.actuators.size(); ++i) {
    if (!open(robot.actuators[i])) continue;
    robot.actuators[i].torque_per_ampere = found.gain[static_cast<Eigen::Index>(i)];
    robot.actuators[i].torque_per_ampere_std = found.std[static_cast<Eigen::Index>(i)];
  }
  return true;
}

}  // namespace knee_robot::identification
