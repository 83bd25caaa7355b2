#include "closed_loop_surrogate.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::tracing {
namespace {

/// Factor by which a surrogate may leave more than the recording does: those of a healthy robot that truly sticks leave
/// 1.3 times as much, of an axis of the laboratory's bench, which does not, 1.5 times, of other laws 5 to 30 times.
constexpr double kTooMuch = 1.4;
// Real robots that stick stand 0.2 to 36 thousandths of the time in which their references move, their surrogates at most
// 6.4 times as long; machines whose friction yields at rest 0.1 to 5, and surrogates that stick 20 to 130.
constexpr double kStandsLonger = 8.0, kStandsAnyway = 0.01;
constexpr double kStanding_s = 0.1, kStanding_m = 2e-4;  ///< time looked at, and how far a reference goes meanwhile
constexpr double kCountsStanding = 1.01, kCountsMoving = 4.0;
constexpr double kStep_s = 0.001;
constexpr double kRecovered = 0.9;  ///< share of the force's variance that a recovered controller must explain
constexpr double kLightest_kg = 2.0;
constexpr double kDerivative_hz = 40.0;  ///< low-pass of the error's derivative: encoders flicker

double valueOf(const BaseFit& base, const Eigen::VectorXd& parameters, identification::ColumnRole role, int actuator) {
  for (std::size_t c = 0; c < base.columns.size(); ++c) {
    if (base.columns[c].role == role && base.columns[c].actuator == actuator)
      return parameters[static_cast<Eigen::Index>(c)] * base.columns[c].newtons;
  }
  return 0.0;
}

/// The parameters without friction: what the motors carry.
Eigen::VectorXd carriedOf(const BaseFit& base, Eigen::VectorXd parameters) {
  for (std::size_t c = 0; c < base.columns.size(); ++c) {
    if (base.columns[c].isFriction()) parameters[static_cast<Eigen::Index>(c)] = 0.0;
  }
  return parameters;
}

/// Mass that each axis moves: slope of the model's force over the acceleration, from the recording's own samples.
double effectiveMass(const identification::Observation& o, const Eigen::VectorXd& load, int i) {
  const Eigen::VectorXd a = o.signals.acceleration_m_per_s2.col(i);
  Eigen::MatrixXd design(o.samples(), 6);
  design.col(0) = a;
  design.col(1).setOnes();
  for (int k = 0; k < 4; ++k)
    design.col(2 + k) =
        k < o.axes() ? Eigen::VectorXd(o.signals.position_m.col(k)) : Eigen::VectorXd::Zero(o.samples());
  const Eigen::VectorXd fit = design.completeOrthogonalDecomposition().solve(load);
  return std::max(kLightest_kg, fit[0]);
}

Eigen::MatrixXd referenceOf(const recording::Recording& r) {
  return r.reference_m.cols() > 0 ? r.reference_m : r.position_m;
}

/// A grid signal at a time, linear.
double at(const recording::Signals& s, const Eigen::MatrixXd& values, int column, double time) {
  const double place = (time - s.time_s.front()) / s.period_s;
  const int k = std::clamp(static_cast<int>(place), 0, s.samples() - 2);
  const double part = std::clamp(place - k, 0.0, 1.0);
  return (1.0 - part) * values(k, column) + part * values(k + 1, column);
}

double explainedShare(const Eigen::MatrixXd& design, const Eigen::VectorXd& target, Eigen::VectorXd& fit) {
  fit = design.colPivHouseholderQr().solve(target);
  const double mean = target.mean();
  return 1.0 - (target - design * fit).squaredNorm() / std::max(1e-12, (target.array() - mean).square().sum());
}

AxisController recover(const recording::Recording& r, const identification::Observation& o, const SurrogatePlan& plan,
                       int i) {
  const Eigen::VectorXd error = referenceOf(r).col(i) - r.position_m.col(i);
  const double period = recording::medianPeriod(r.time_s);
  Eigen::MatrixXd design(r.rows(), 4);
  Eigen::VectorXd load(r.rows());
  double sum = 0.0, rate = 0.0;
  const double fast = std::min(1.0, kTwoPi * kDerivative_hz * period);
  for (int k = 0; k < r.rows(); ++k) {
    sum += error[k] * period;
    const double raw = k > 0 ? (error[k] - error[k - 1]) / period : 0.0;
    rate += fast * (raw - rate);
    design.row(k) << error[k], sum, rate, 1.0;
    load[k] = at(o.signals, plan.load_N, i, r.time_s[static_cast<std::size_t>(k)]);
  }
  AxisController c;
  Eigen::VectorXd fit;
  for (const bool forward : {false, true}) {
    const Eigen::VectorXd target = forward ? Eigen::VectorXd(o.row_force_N.col(i) - load) : o.row_force_N.col(i);
    if (r.reference_m.cols() == 0 || explainedShare(design, target, fit) < kRecovered) continue;
    if (fit[0] <= 0.0) continue;
    c = {fit[0], std::max(0.0, fit[1]), std::max(0.0, fit[2]), true, forward};
    return c;
  }
  return c;
}

struct AxisState {
  double q, v = 0.0, sum = 0.0, last_error = 0.0, rate = 0.0, start_force;
};

/// Semi-implicit step of a mass with viscous friction and stiction.
void move(AxisState& a, const SurrogatePlan& plan, int i, double push, double level, double h) {
  const double m = plan.mass_kg[i];
  const double free = (a.v + h / m * push) / (1.0 + h / m * plan.viscous[i]);
  const double most = h / m * level;
  a.v = std::abs(free) <= most ? 0.0 : free - std::copysign(most, free);
  a.q += h * a.v;
}

/// One axis of a surrogate: fills its column of positions and forces.
void simulateAxis(const mechanism::Robot& robot, const recording::Recording& r, const identification::Observation& o,
                  const SurrogatePlan& plan, int i, double phase, recording::Recording& surrogate) {
  const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
  const AxisController& c = plan.controllers[static_cast<std::size_t>(i)];
  const Eigen::MatrixXd reference = referenceOf(r);
  const double period = recording::medianPeriod(r.time_s);
  const double fast = std::min(1.0, kTwoPi * kDerivative_hz * period);
  const double count = a.metresPerCount();
  const double dac = recording::kDacStep_V * a.force_per_volt_N, limit = a.voltage_max_V * a.force_per_volt_N;
  AxisState axis{r.position_m(0, i), 0.0, 0.0, 0.0, 0.0, 0.0};
  axis.start_force = o.row_force_N(0, i) - (c.feeds_load_forward ? plan.load_N(0, i) : 0.0) -
                     c.kp * (reference(0, i) - r.position_m(0, i));
  for (int k = 0; k < r.rows(); ++k) {
    const double time = r.time_s[static_cast<std::size_t>(k)];
    const double seen = count * (std::floor(axis.q / count + phase) - phase + 0.5);
    const double error = reference(k, i) - seen;
    axis.sum += error * period;
    if (k > 0) axis.rate += fast * ((error - axis.last_error) / period - axis.rate);
    axis.last_error = error;
    double force = axis.start_force + c.kp * error + c.ki * axis.sum + c.kd * axis.rate;
    if (c.feeds_load_forward) force += at(o.signals, plan.load_N, i, time);
    force = std::clamp(dac * std::round(force / dac), -limit, limit);
    surrogate.position_m(k, i) = seen;
    surrogate.force_N(k, i) = force;
    if (k + 1 == r.rows()) break;
    const double interval = r.time_s[static_cast<std::size_t>(k) + 1] - time;
    const int steps = std::max(1, static_cast<int>(std::ceil(interval / kStep_s - 1e-6)));
    for (int s = 0; s < steps; ++s) {
      const double now = time + (s + 0.5) * interval / steps;
      move(axis, plan, i, force - at(o.signals, plan.load_N, i, now), at(o.signals, plan.level_N, i, now),
           interval / steps);
    }
  }
}

/// One axis of a surrogate along the measured motion: the model's force, encoder counts with another phase.
void followMeasured(const mechanism::Robot& robot, const recording::Recording& r, const identification::Observation& o,
                    const SurrogatePlan& plan, int i, double phase, recording::Recording& surrogate) {
  const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
  const double dac = recording::kDacStep_V * a.force_per_volt_N;
  const double half = 0.5 * recording::medianPeriod(r.time_s);
  for (int k = 0; k < r.rows(); ++k) {
    const double time = r.time_s[static_cast<std::size_t>(k)];
    const double q = r.position_m(k, i) + (phase - 0.5) * a.metresPerCount();
    surrogate.position_m(k, i) = a.metresPerCount() * std::round(q / a.metresPerCount());
    surrogate.force_N(k, i) = dac * std::round(at(o.signals, plan.model_N, i, time + half) / dac);
  }
}

recording::Recording emptySurrogate(const recording::Recording& r) {
  recording::Recording surrogate = r;
  surrogate.force_N.resize(r.rows(), r.axes);
  surrogate.command_V.resize(r.rows(), 0);
  surrogate.velocity_m_per_s.resize(r.rows(), 0);
  return surrogate;
}

/// Share of the time in which an axis' reference moves and the axis stands.
double standingShare(const recording::Recording& r, const Eigen::MatrixXd& reference, int i, double count_m) {
  const int window = std::max(2, static_cast<int>(std::lround(kStanding_s / recording::medianPeriod(r.time_s))));
  int moves = 0, stands = 0;
  for (int k = window; k < r.rows(); ++k) {
    const double asked = std::abs(reference(k, i) - reference(k - window, i));
    if (asked < std::max(kCountsMoving * count_m, kStanding_m)) continue;
    ++moves;
    stands += std::abs(r.position_m(k, i) - r.position_m(k - window, i)) <= kCountsStanding * count_m;
  }
  return moves > 0 ? static_cast<double>(stands) / moves : 0.0;
}

/// Whether the surrogate, as the plan is, sticks where the machine does not: its friction is no stiction.
bool sticksTooMuch(const mechanism::Robot& robot, const recording::Recording& r, const identification::Observation& o,
                   const SurrogatePlan& plan, int i) {
  recording::Recording surrogate = emptySurrogate(r);
  simulateAxis(robot, r, o, plan, i, 0.5, surrogate);
  const double count_m = robot.actuators[static_cast<std::size_t>(i)].metresPerCount();
  const Eigen::MatrixXd reference = referenceOf(r);
  return standingShare(surrogate, reference, i, count_m) >
         kStandsLonger * standingShare(r, reference, i, count_m) + kStandsAnyway;
}

/// The effective mass that makes the surrogate follow the recorded motion best. A regression over the acceleration
/// gives too much where something else goes with the acceleration, and a surrogate that is too heavy overshoots where
/// the machine stops.
void chooseMass(const mechanism::Robot& robot, const recording::Recording& r, const identification::Observation& o,
                const Eigen::VectorXd& load, int i, SurrogatePlan& plan) {
  const double fitted = plan.mass_kg[i];
  double best = fitted, least = std::numeric_limits<double>::infinity();
  recording::Recording surrogate = emptySurrogate(r);
  const auto use = [&](double mass) {
    plan.mass_kg[i] = mass;
    plan.load_N.col(i) = load - mass * o.signals.acceleration_m_per_s2.col(i);
  };
  for (const double factor : {1.0, 0.5, 0.25, 0.12, 0.06, 0.03}) {
    if (factor < 1.0 && factor * fitted < kLightest_kg) continue;
    use(factor * fitted);
    simulateAxis(robot, r, o, plan, i, 0.5, surrogate);
    const double away = (surrogate.position_m.col(i) - r.position_m.col(i)).norm();
    if (!(away < least)) continue;
    least = away;
    best = factor * fitted;
  }
  use(best);
}

/// Opens the loops of axes whose controller was recovered in half of the recordings or fewer: all are one machine's, and
/// what few of them show is not its controller. `open`: the loop of every recording is.
std::vector<std::string> openWhereFewAreRecovered(std::vector<char>& open, std::vector<SurrogatePlan>& plans) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto closed = static_cast<std::size_t>(
        std::count_if(plans.begin(), plans.end(), [&](const SurrogatePlan& p) { return p.open_loop[i] == 0; }));
    if (open[i] || 2 * closed > plans.size()) continue;
    open[i] = 1;
    for (SurrogatePlan& plan : plans)
      plan.open_loop[i] = 1;
    notes.push_back("Actuator " + std::to_string(i + 1) + ": its controller was recovered in " +
                    std::to_string(closed) + " of " + std::to_string(plans.size()) +
                    " recordings only, so its surrogates follow the measured motion; they miss part of what reversals "
                    "leave.");
  }
  return notes;
}

}  // namespace

SurrogatePlan planSurrogate(const mechanism::Robot& robot, const recording::Recording& r,
                            const identification::Observation& o, const BaseFit& base) {
  SurrogatePlan plan;
  plan.load_N.resize(o.samples(), o.axes());
  plan.mass_kg.resize(o.axes());
  plan.viscous.resize(o.axes());
  plan.level_N.resize(o.samples(), o.axes());
  plan.model_N.resize(o.samples(), o.axes());
  plan.open_loop.assign(static_cast<std::size_t>(o.axes()), 0);
  const Eigen::VectorXd carried = carriedOf(base, base.parameters);
  int recovered = 0;
  for (int i = 0; i < o.axes(); ++i) {
    const Eigen::VectorXd load = o.regressor[static_cast<std::size_t>(i)] * carried;
    plan.model_N.col(i) = o.regressor[static_cast<std::size_t>(i)] * base.parameters;
    plan.mass_kg[i] = effectiveMass(o, load, i);
    plan.load_N.col(i) = load - plan.mass_kg[i] * o.signals.acceleration_m_per_s2.col(i);
    plan.viscous[i] = valueOf(base, base.parameters, identification::ColumnRole::Viscous, i);
    plan.level_N.col(i).setConstant(valueOf(base, base.parameters, identification::ColumnRole::Coulomb, i));
  }
  for (int i = 0; i < o.axes(); ++i) {
    plan.controllers.push_back(recover(r, o, plan, i));
    const Eigen::VectorXd load = o.regressor[static_cast<std::size_t>(i)] * carried;
    const bool known = plan.controllers.back().recovered;
    plan.open_loop[static_cast<std::size_t>(i)] = !known;
    if (known) chooseMass(robot, r, o, load, i, plan);
    plan.sticks_too_much.push_back(known && sticksTooMuch(robot, r, o, plan, i));
    recovered += known;
  }
  plan.note = o.name + ": controllers of " + std::to_string(recovered) + " of " + std::to_string(o.axes()) +
              " axes recovered from the tracking error, their surrogates in closed loop";
  if (recovered < o.axes()) plan.note += ", the surrogates of the others follow the measured motion";
  return plan;
}

std::vector<std::string> openLoops(const Eigen::VectorXd& left_N, const Eigen::VectorXd& real_N,
                                   std::vector<SurrogatePlan>& plans) {
  std::vector<char> open(plans.front().open_loop.size(), 1);  // of every recording: one is enough to spoil the others
  for (const SurrogatePlan& plan : plans) {
    for (std::size_t i = 0; i < open.size(); ++i)
      open[i] = open[i] && plan.open_loop[i];
  }
  std::vector<std::string> notes = openWhereFewAreRecovered(open, plans);
  const auto sticks = [&](std::size_t i) {
    return std::any_of(plans.begin(), plans.end(), [&](const SurrogatePlan& p) { return p.sticks_too_much[i] != 0; });
  };
  int closed = 0, unlike = 0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Eigen::Index k = static_cast<Eigen::Index>(i);
    closed += !open[i];
    unlike += !open[i] && (sticks(i) || left_N[k] > kTooMuch * real_N[k]);
  }
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Eigen::Index k = static_cast<Eigen::Index>(i);
    const bool more = left_N[k] > kTooMuch * real_N[k];
    if (open[i] || !(more || sticks(i) || 2 * unlike > closed)) continue;
    for (SurrogatePlan& plan : plans)
      plan.open_loop[i] = 1;
    notes.push_back("Actuator " + std::to_string(i + 1) + ": a surrogate in closed loop leaves " +
                    shortNumber(left_N[k], 3) + " N, " +
                    (more        ? "more than the recording (" + shortNumber(real_N[k], 3) + " N)"
                     : sticks(i) ? std::string("and stands still where the machine does not")
                                 : std::string("and those of most other actuators are not like the machine")) +
                    ", so its surrogates follow the measured motion; they miss part of what reversals leave.");
  }
  return notes;
}

void refreshPlan(const identification::Observation& o, const BaseFit& base, const Eigen::VectorXd& parameters,
                 const Eigen::MatrixXd& share, const SurrogateEffects& effects, SurrogatePlan& plan) {
  const Eigen::VectorXd carried = carriedOf(base, parameters);
  for (int i = 0; i < o.axes(); ++i) {
    const Eigen::MatrixXd& regressor = o.regressor[static_cast<std::size_t>(i)];
    plan.load_N.col(i) = regressor * carried - plan.mass_kg[i] * o.signals.acceleration_m_per_s2.col(i);
    plan.model_N.col(i) = regressor * parameters;
    plan.viscous[i] = valueOf(base, parameters, identification::ColumnRole::Viscous, i);
    plan.level_N.col(i).setConstant(valueOf(base, parameters, identification::ColumnRole::Coulomb, i));
    if (effects.load_N.size() == 0) continue;
    plan.load_N.col(i) += effects.load_N.col(i);
    plan.model_N.col(i) += effects.load_N.col(i) + effects.friction_N.col(i);
    for (int n = 0; n < o.samples(); ++n) {
      const double direction = share(n, i) < 0.0 ? -1.0 : 1.0;
      plan.level_N(n, i) = std::max(0.0, plan.level_N(n, i) + direction * effects.friction_N(n, i));
    }
  }
}

recording::Recording simulateSurrogate(const mechanism::Robot& robot, const recording::Recording& r,
                                       const identification::Observation& o, const SurrogatePlan& plan,
                                       std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  recording::Recording surrogate = emptySurrogate(r);
  for (int i = 0; i < r.axes; ++i) {
    if (plan.open_loop[static_cast<std::size_t>(i)]) {
      followMeasured(robot, r, o, plan, i, uniform(random), surrogate);
    } else {
      simulateAxis(robot, r, o, plan, i, uniform(random), surrogate);
    }
  }
  return surrogate;
}

}  // namespace knee_robot::tracing
