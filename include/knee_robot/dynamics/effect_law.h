#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot::dynamics {

/// What has passed since a path turned, or since it began.
struct SinceReversal {
  /// Distance from the turning point where this stroke began, never negative. A way back within the stroke is
  /// forgotten as soon as the path passes the point where it had turned back, as hysteresis forgets closed loops
  /// (Madelung's rules): a controller that trembles at rest begins no stroke.
  double way_m = 0.0;
  double time_s = 0.0;         ///< since the path turned last
  double way_of_last_m = 0.0;  ///< from where it turned last, whatever loops it has closed since; never negative
  bool turned = false;         ///< since it began: else it is not known how long this stroke is
};

/// What the law of an effect may look at: one instant of a motion, and one actuator of it.
struct EffectInstant {
  double period_s = 0.0;                                       ///< since the instant before; 0 at the first one
  mechanism::Vector4 position_m = mechanism::Vector4::Zero();  ///< of all actuators, as the next
  mechanism::Vector4 velocity_m_per_s = mechanism::Vector4::Zero();
  const mechanism::Mechanism* mechanism = nullptr;  ///< null: bench axes, as the next
  const mechanism::Motion* motion = nullptr;        ///< of the platform
  double fade = 1.0;  ///< what an instant at rest leaves of a friction that builds up with the way
                      ///< (FrictionState::fade): at rest of the actuator, or of all of them

  int actuator = 0;                 ///< 0 .. axes - 1; what follows is this actuator's
  double share = 0.0;               ///< of Coulomb friction, in [-1, 1], by the law near rest
  double displacement_m = 0.0;      ///< of friction's path since the instant before; 0 at the first one
  SinceReversal since_reversal;     ///< of its path
  double load_N = 0.0;              ///< what the screw carries: rigid body, rotor, offset
  double force_N = 0.0;             ///< the whole model's force
  double force_rate_N_per_s = 0.0;  ///< its rate
};

inline constexpr int kMostJointAxes = 11;
/// What friction in joints without motors remembers.
struct JointMemory {
  std::array<double, kMostJointAxes> bent{};                      ///< bristles: share of Coulomb friction, in [-1, 1]
  mechanism::Vector4 pose_velocity = mechanism::Vector4::Zero();  ///< at the instant before
};

/// What a law remembers of the motion.
struct EffectState {
  double value = 0.0;
  double rate = 0.0;  ///< of what it looks at, at the instant before
  mechanism::Vector4 of_pose = mechanism::Vector4::Zero();
  JointMemory of_joints;
};

/// Which part of the force an effect belongs to.
enum class EffectPart {
  Carried,   ///< there at rest as well, as weight
  Friction,  ///< follows the way or the velocity
  Ahead,     ///< of the force's rate: for what acts later than it was asked for
  Gain,      ///< a share of the whole force
};

inline constexpr int kMostColumns = 16;
using EffectColumns = std::array<double, kMostColumns>;
/// Generalized forces (N, N, N m, N m) on the pose, a column a coefficient.
using PoseColumns = Eigen::Matrix<double, 4, kMostColumns>;

/// The law of one effect that `trace` can add, instant by instant: the force per unit of each of its coefficients. The
/// same as the columns with which it was traced (tracing/candidate.h). One file a law: src/dynamics/effects. Constant;
/// what it remembers is with the caller. Real-time safe.
class EffectLaw {
 public:
  virtual ~EffectLaw() = default;
  virtual EffectPart part() const noexcept = 0;
  virtual int coefficients() const noexcept { return 1; }
  /// Of a model file's coefficients, where some belong to one training recording each: those of any other recording.
  virtual std::vector<double> inOtherRecordings(std::vector<double> coefficients) const;
  /// True: acts on the pose, and so on all actuators together.
  virtual bool shared() const noexcept { return false; }
  /// Force (N) of the actuator per unit of each coefficient. To be called once per instant, in order of time, where
  /// `state` matters.
  virtual void columns(const EffectInstant& at, EffectState& state, EffectColumns& out) const noexcept;
  /// Of a shared one: what the actuators have to bring up. Of the instant it looks at mechanism, motion, period and
  /// fade.
  virtual void poseColumns(const EffectInstant& at, EffectState& state, PoseColumns& out) const noexcept;
  /// The drives are off for so long (s).
  virtual void rest(double duration_s, EffectState& state) const noexcept;
};

/// The law of an effect of a model file, by its name, signal (`depends_on`, of an unnamed one) and shape. Null: there
/// is no law instant by instant; see whyNotInstantly.
std::unique_ptr<const EffectLaw> effectLaw(const std::string& name, const std::string& depends_on,
                                           const std::vector<double>& shape);

/// Why the feedforward leaves out an effect of this name; empty: the name is unknown.
std::string whyNotInstantly(const std::string& name);
/// Of an effect without a law instant by instant: false where it is the patient's, a load that is declared, or lies in
/// the recording alone. All others act on while the robot runs, though nothing is fed forward against them.
bool actsOnWithoutLaw(const std::string& name);

}  // namespace knee_robot::dynamics
