#pragma once

#include <optional>
#include <string>

#include "knee_robot/dynamics/auxiliary_dynamics.h"

namespace knee_robot::control {

/// How the identified model takes part in the control; names as in the deployment file.
enum class Law {
  Feedforward,     ///< "feedforward": the model goes by the reference, the Drivers' PID by the error
  ComputedTorque,  ///< "computed_torque": the error passes through the model's inertia
  PassivityBased,  ///< "passivity_based": Slotine and Li's; the Drivers' PID is its passive part
};
std::optional<Law> lawNamed(const std::string& name);

/// What the feedback through the model adds to the feedforward, N per actuator. q: actuated lengths, e = q_d - q; M, C,
/// V, g: mass, Coriolis (Christoffel), viscous friction and weight of the identified model in q; f_c: its dry friction
/// along the reference, shares of the feedforward left aside. The whole force of the axes is, by law,
///
///     feedforward       F = g(q) + M q''_d + C(q'_d) q'_d + V q'_d + f_c + PID(e)
///     computed_torque   F = g(q) + M (q''_d + K_v e' + K_p e) + C(q') q' + V q' + f_c + I integral(e)
///     passivity_based   F = g(q) + M q''_r + C(q') q'_r + V q'_r + f_c + PID(e)
///                       with q'_r = q'_d + L e, q''_r = q''_d + L e'
///
/// where PID(e) = P e + D e' + I z, z = integral(e), are the Drivers' own loops, one an axis; force() is the difference
/// to the first line.
///
/// Computed torque, exact model: e'' + K_v e' + K_p e = 0, of all axes alike and apart. Its error in M multiplies the
/// feedback.
///
/// Passivity. With s = q'_r - q' = e' + L e and an exact model the third line leaves M s' + C(q') s + V s + PID(e) = d,
/// d being what else acts. PID(e) = D s + k e + I z with k = P - D L. Storage
///
///     S = 1/2 s^T M s + sum over axes (1/2 k e^2 + I e z + 1/2 L I z^2)
///
/// is positive where k > 0 and k L >= I, and as d/dt M - 2C is skew-symmetric,
///
///     S' = s^T d - s^T V s - sum (D s^2 + (k L - I) e^2).
///
/// So the closed loop is passive from d to s: no disturbance, patient or wrong load takes more energy out of it than
/// was put in, and for d = 0 s and e go to zero (Barbalat). What the model does not know is part of d; an error in g or
/// in friction shifts nothing but d. An error in M or C leaves the first term with the true M and d with (M^ - M) q''_r
/// + (C^ - C) q'_r, which is small where the movement is slow. The condition is on gains alone: (P - D L) L >= I, so L
/// lies between the zeros of D L^2 - P L + I. Not covered by the proof, and therefore measured
/// (docs/results/control_laws.md): sampling, the low-pass of the velocity, the clamp, friction that sticks.
/// J.-J. Slotine, W. Li: On the adaptive control of robot manipulators, 1987; R. Ortega, M. Spong: Adaptive motion
/// control of rigid robots: a tutorial, 1989.
///
/// One a robot; real-time safe.
class ControlLaw {
 public:
  /// Of the deployment file, the same for all legs.
  struct Gains {
    double stiffness_per_s2 = 0.0;  ///< K_p
    double damping_per_s = 0.0;     ///< K_v
    double lambda_per_s = 0.0;      ///< L
    double cutoff_hz = 100.0;       ///< low-pass of the measured velocity
  };
  /// One cycle: what was measured, and the reference.
  struct Instant {
    mechanism::Pose pose = mechanism::Pose::Zero();
    mechanism::Vector4 position = mechanism::Vector4::Zero();      ///< measured, m
    mechanism::Vector4 reference = mechanism::Vector4::Zero();     ///< m, at the same time
    mechanism::Vector4 velocity = mechanism::Vector4::Zero();      ///< of the reference, m/s
    mechanism::Vector4 acceleration = mechanism::Vector4::Zero();  ///< of the reference, m/s^2
    double dt = 0.0;                                               ///< s since the last instant
  };

  /// Before the first instant.
  void choose(Law law) noexcept { law_ = law; }
  Law law() const noexcept { return law_; }
  /// The law has a feedback of its own for position and velocity: the Drivers keep their integral only.
  bool closesLoop() const noexcept { return law_ == Law::ComputedTorque; }
  /// At rest here; the low-pass forgets.
  void reset(const mechanism::Vector4& position) noexcept;
  /// Force (N); zero for Law::Feedforward. Once an instant, in order of time. False, with `force` zero, where the
  /// mechanism is singular.
  bool force(const dynamics::PartedModel& model, const Gains& gains, const Instant& at,
             mechanism::Vector4& force) noexcept;
  /// Between which L (1/s) the Driver's loop with these gains is passive: half a sentence when `lambda` is not, or
  /// empty.
  static std::string whyNotPassive(double lambda, double proportional, double integral, double derivative);

 private:
  Law law_ = Law::Feedforward;
  mechanism::Vector4 velocity_ = mechanism::Vector4::Zero(), last_position_ = mechanism::Vector4::Zero();
  dynamics::AuxiliaryData data_;
};

}  // namespace knee_robot::control
