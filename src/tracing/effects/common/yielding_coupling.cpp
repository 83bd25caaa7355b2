#include "yielding_coupling.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "../../length_response.h"
#include "screw_behind_joint.h"

namespace knee_robot::tracing {
namespace {

/// How far the coupling is wound, its rate and acceleration, by backward differences of second order: what is stiffer
/// than a sample can show does not ring.
class Wound {
 public:
  explicit Wound(double period_s) : h_(period_s) {}

  void rest(double wound_m) {
    now_ = before_ = wound_m;
    rate_ = rate_before_ = acceleration_ = 0.0;
  }
  /// The acceleration, and the rate, are this much for each metre that the next value is larger ...
  double accelerationPer_m() const { return 2.25 / (h_ * h_); }
  double ratePer_m() const { return 1.5 / h_; }
  /// ... and this much where it is zero.
  double accelerationAtZero() const { return 1.5 / h_ * rateAtZero() + (-2.0 * rate_ + 0.5 * rate_before_) / h_; }
  double rateAtZero() const { return (-2.0 * now_ + 0.5 * before_) / h_; }

  void next(double wound_m) {
    acceleration_ = accelerationPer_m() * wound_m + accelerationAtZero();
    const double rate = ratePer_m() * wound_m + rateAtZero();
    rate_before_ = rate_;
    rate_ = rate;
    before_ = now_;
    now_ = wound_m;
  }
  double wound_m() const { return now_; }
  double rate() const { return rate_; }
  double acceleration() const { return acceleration_; }

 private:
  const double h_;
  double now_ = 0.0, before_ = 0.0, rate_ = 0.0, rate_before_ = 0.0, acceleration_ = 0.0;
};

/// How the loads answer to the leg's length at a sample.
struct Answer {
  Eigen::VectorXd stiffness, mass;  ///< of every actuator, per metre and per m/s^2 that the leg is longer
};

Answer answerAt(const EffectInput& in, int leg, int sample) {
  Answer a = {Eigen::VectorXd::Zero(in.axes()), Eigen::VectorXd::Zero(in.axes())};
  const LengthResponse::Knot knot = in.by_lengths ? in.by_lengths->at(in, sample) : LengthResponse::Knot();
  if (knot.known) {
    a.stiffness = knot.stiffness.col(leg);
    a.mass = knot.mass.col(leg);
  } else {
    a.mass[leg] = in.moved_kg[leg];
  }
  return a;
}

/// The screw behind the spring along a recording.
struct ScrewPath {
  explicit ScrewPath(const EffectInput& in) : longer(in.samples(), in.axes()), carried_N(in.samples()) {}
  LengthPath longer;          ///< of the leg, less than its encoder says: negative where the load is positive
  Eigen::VectorXd carried_N;  ///< by the spring: what the motor feels
};

/// `beyond_N`: by which the load differs from the first order of what it is along the encoders' path.
ScrewPath screwPath(const EffectInput& in, int i, const YieldingCoupling& coupling, const Eigen::VectorXd& beyond_N) {
  const auto motor = in.friction_position_m.col(i);
  const double period = in.signals().period_s, spring = coupling.stiffness_N_per_m;
  DriveJoint joint;
  joint.stiffness_N_per_m = spring;
  ScrewBehindJoint screw(joint, in.laws[static_cast<std::size_t>(i)], coupling.friction_beyond * in.coulomb_N[i],
                         coupling.friction_beyond * in.viscous[i]);
  Wound wound(period);
  ScrewPath path(in);
  for (int n = 0; n < in.samples(); ++n) {
    const Answer answer = answerAt(in, i, n);
    const double load = in.load_N(n, i) - in.rotor_kg[i] * in.signals().acceleration_m_per_s2(n, i) + beyond_N[n];
    const double mass = std::max(0.0, answer.mass[i]),
                 damping = 2.0 * coupling.damping_ratio * std::sqrt(spring * mass);
    if (n == 0) {
      const double at = load / std::max(spring + answer.stiffness[i], 0.5 * spring);
      screw.start(motor[0], at, in.share(0, i));
      wound.rest(at);
    } else {
      YieldingLoad yielding;
      yielding.at_zero_N = load - mass * wound.accelerationAtZero() - damping * wound.rateAtZero();
      yielding.falls_N_per_m = answer.stiffness[i] + mass * wound.accelerationPer_m() + damping * wound.ratePer_m();
      wound.next(screw.follow(motor[n], yielding, period));
    }
    path.longer.length_m(n, i) = -wound.wound_m();
    path.longer.rate(n, i) = -wound.rate();
    path.longer.acceleration(n, i) = -wound.acceleration();
    path.carried_N[n] = spring * wound.wound_m() + damping * wound.rate();
  }
  return path;
}

}  // namespace

Eigen::MatrixXd changeByCoupling(const EffectInput& in, int i, const YieldingCoupling& coupling) {
  Eigen::MatrixXd beyond = Eigen::MatrixXd::Zero(in.samples(), in.axes());
  ScrewPath path = screwPath(in, i, coupling, beyond.col(i));
  if (in.by_lengths && path.longer.length_m.cwiseAbs().maxCoeff() >= kFirstOrder_m) {
    beyond = in.by_lengths->beyondFirstOrder(in, path.longer);
    path = screwPath(in, i, coupling, beyond.col(i));
    beyond = in.by_lengths->beyondFirstOrder(in, path.longer);
  }
  Eigen::MatrixXd change(in.samples(), in.axes());
  for (int n = 0; n < in.samples(); ++n) {
    const Answer answer = answerAt(in, i, n);
    change.row(n) =
        (answer.stiffness * path.longer.length_m(n, i) + answer.mass * path.longer.acceleration(n, i)).transpose() +
        beyond.row(n);
    const double load = in.load_N(n, i) - in.rotor_kg[i] * in.signals().acceleration_m_per_s2(n, i);
    change(n, i) = path.carried_N[n] - load -
                   coupling.friction_beyond *
                       (in.coulomb_N[i] * in.share(n, i) + in.viscous[i] * in.signals().velocity_m_per_s(n, i));
  }
  return forceOrNone(std::move(change));
}

}  // namespace knee_robot::tracing
