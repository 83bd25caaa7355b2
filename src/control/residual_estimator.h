#pragma once

#include <array>
#include <optional>

#include "knee_robot/dynamics/force_parts.h"
#include "knee_robot/mechanism/pose_follower.h"

namespace knee_robot::control {

/// What is known of the forces: the model in use, how much friction may hide at rest, and how well the model explained
/// its recordings.
struct ForceKnowledge {
  /// The weights of the robot's URDF: friction is not known, no band is promised.
  ForceKnowledge(const mechanism::Robot& robot, const std::optional<dynamics::RobotInertia>& inertia);
  /// An identified model. InputError as PartedModel.
  ForceKnowledge(const dynamics::Model& model, const mechanism::Robot& robot);

  static constexpr double kBand = 3.0;             ///< times the rms that the model left of its recordings
  static constexpr double kUnknownBand = 0.02;     ///< of the force limit, where the model file does not say
  static constexpr double kUnknownFriction = 0.1;  ///< of the force limit, where friction is not identified

  dynamics::PartedModel parts;
  bool identified = false;
  bool traced = false;           ///< with effects, which remember
  mechanism::Vector4 coulomb_N;  ///< what may hide in a standing axis
  mechanism::Vector4 band_N;     ///< of the residual's rms
};

/// Commanded less expected force, and the wrench on the platform that would explain the difference.
///
///     residual = F - (weight + payload + inertia + friction at the measured pose and motion)
///     certain  = residual beyond the Coulomb friction that may hide at this speed: all of it at rest, none in motion
///     wrench   = -J^T certain                 on the robot's coordinates Xm, Zm (N), theta, psi (N m); J = dq/dx
///
/// Force, velocity and acceleration pass the same low-pass (twice kCutoff_hz), so that delay makes no residual.
/// Friction at rest is no measurement: a push that it bears is not seen. Test pulses have no mean and hardly pass the
/// filter. One a robot; real-time safe.
class ResidualEstimator {
 public:
  static constexpr double kCutoff_hz = 5.0;
  static constexpr double kSlow_m_per_s = 1e-3;  // friction is certain above about twice that
  static constexpr double kRms_s = 10.0;         // time constant of the running rms
  static constexpr double kSettle_s = 0.3;       // after a start the filters have to forget it

  /// Measurement and written force of one cycle.
  struct Input {
    mechanism::Lengths position_m;
    mechanism::Vector4 velocity_m_per_s;  ///< measured
    mechanism::Vector4 force_N;           ///< written, for the time that this measurement ends
    double payload_kg = 0.0;              ///< declared
    double dt = 0.0;
  };
  /// Per leg and at the platform: what the model does not expect.
  struct Estimate {
    bool known = false;  ///< there is a pose, and the filters have settled
    mechanism::Vector4 expected_N = mechanism::Vector4::Zero();
    mechanism::Vector4 residual_N = mechanism::Vector4::Zero();
    mechanism::Vector4 certain_N = mechanism::Vector4::Zero();
    mechanism::Vector4 rms_N = mechanism::Vector4::Zero();       ///< of `certain_N`
    mechanism::Vector4 friction_N = mechanism::Vector4::Zero();  ///< the part of expected_N that is friction
    mechanism::Vector4 moving = mechanism::Vector4::Zero();      ///< 0 at rest, 1 when friction is certain
    mechanism::Vector4 wrench = mechanism::Vector4::Zero();
    mechanism::Vector4 wrench_band = mechanism::Vector4::Zero();  ///< what the bands of the legs can look like
    mechanism::Vector4 hidden_N = mechanism::Vector4::Zero();     ///< Coulomb friction that may hide in the residual
    mechanism::Matrix4 jacobian = mechanism::Matrix4::Zero();
    mechanism::Pose pose = mechanism::Pose::Zero();
  };

  /// What of `residual` is beyond what friction may hide now.
  static mechanism::Vector4 certain(const mechanism::Vector4& residual, const mechanism::Vector4& hidden) noexcept;
  /// The Drivers do not carry: everything is forgotten but the rms.
  void reset() noexcept;
  /// One new measurement.
  const Estimate& step(const ForceKnowledge& knowledge, const Input& input) noexcept;
  const Estimate& estimate() const noexcept { return out_; }

 private:
  bool expect(const ForceKnowledge& knowledge, const Input& in, const mechanism::Vector4& acceleration) noexcept;
  bool findPose(const ForceKnowledge& knowledge, const mechanism::Lengths& lengths) noexcept;

  struct TwicePassed {
    mechanism::Vector4 once = mechanism::Vector4::Zero(), twice = mechanism::Vector4::Zero();
    void step(const mechanism::Vector4& value, double share) noexcept {
      once += share * (value - once);
      twice += share * (once - twice);
    }
  };
  TwicePassed force_, velocity_;
  double settled_s_ = 0.0;
  mechanism::PoseFollower pose_;
  dynamics::ForcePartsData data_;
  dynamics::ForceParts parts_;
  Estimate out_;
};

}  // namespace knee_robot::control
