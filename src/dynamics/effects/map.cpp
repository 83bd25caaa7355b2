#include <algorithm>
#include <array>
#include <optional>

#include "knee_robot/mechanism/kinematics.h"
#include "knots.h"

namespace knee_robot::dynamics {
namespace {

enum class Factor { One, Direction, Velocity };
enum class Signal { Position, Velocity, VelocityPair, WaySinceReversal, TimeSinceReversal, Load, Pose, LegAngle };

struct Source {
  Signal signal = Signal::Position;
  int index = 0;        ///< actuator or leg, or the pose's coordinate
  bool second = false;  ///< of a leg's angles: q2
  int other = 0;        ///< of a pair: the other actuator,
  double sign = 1.0;    ///< whose velocity is added or subtracted
  Factor factor = Factor::One;
};

bool cutOff(std::string& text, const std::string& end) {
  if (text.size() < end.size() || text.compare(text.size() - end.size(), end.size(), end) != 0) return false;
  text.resize(text.size() - end.size());
  return true;
}

/// The number N of a text before_N_after, 1 to 4, as an index; -1: the text is another one.
int numbered(const std::string& text, const std::string& before, const std::string& after) {
  for (int n = 1; n <= mechanism::kLegs; ++n) {
    if (text == before + std::to_string(n) + after) return n - 1;
  }
  return -1;
}

std::optional<Source> sourceOf(std::string text) {
  Source s;
  if (cutOff(text, "_times_direction"))
    s.factor = Factor::Direction;
  else if (cutOff(text, "_times_velocity"))
    s.factor = Factor::Velocity;
  const std::array<const char*, 4> pose = {"pose_x_m", "pose_z_m", "pose_theta_rad", "pose_psi_rad"};
  const auto coordinate = std::find(pose.begin(), pose.end(), text);
  if (coordinate != pose.end()) {
    s.signal = Signal::Pose;
    s.index = static_cast<int>(coordinate - pose.begin());
    return s;
  }
  const auto is = [&](const char* before, const char* after, Signal signal, bool second = false) {
    const int index = numbered(text, before, after);
    if (index < 0) return false;
    s.signal = signal;
    s.index = index;
    s.second = second;
    return true;
  };
  if (is("position_", "_m", Signal::Position) || is("velocity_", "_m_per_s", Signal::Velocity) ||
      is("distance_since_reversal_", "_m", Signal::WaySinceReversal) ||
      is("time_since_reversal_", "_s", Signal::TimeSinceReversal) || is("load_", "_N", Signal::Load) ||
      is("leg_", "_angle_q1_rad", Signal::LegAngle) || is("leg_", "_angle_q2_rad", Signal::LegAngle, true))
    return s;
  for (s.other = 0; s.other < mechanism::kLegs; ++s.other) {
    const std::string end = "_velocity_" + std::to_string(s.other + 1) + "_m_per_s";
    s.sign = 1.0;
    if (is("velocity_", ("_plus" + end).c_str(), Signal::VelocityPair)) return s;
    s.sign = -1.0;
    if (is("velocity_", ("_minus" + end).c_str(), Signal::VelocityPair)) return s;
  }
  return std::nullopt;
}

/// A piecewise linear function of one signal, constant beyond what training has seen: force, dry friction or viscous
/// friction.
class Map : public EffectLaw {
 public:
  Map(const Source& source, const Shape& knots) : source_(source), knots_(knots) {}
  EffectPart part() const noexcept override {
    const bool carried =
        source_.factor == Factor::One && source_.signal != Signal::Velocity && source_.signal != Signal::VelocityPair;
    return carried ? EffectPart::Carried : EffectPart::Friction;
  }
  int coefficients() const noexcept override { return knots_.count; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    const double factor = source_.factor == Factor::One         ? 1.0
                          : source_.factor == Factor::Direction ? at.share
                                                                : at.velocity_m_per_s[at.actuator];
    knots_.hats(signal(at), factor, out);
  }

 private:
  double signal(const EffectInstant& at) const noexcept {
    switch (source_.signal) {
      case Signal::Position:
        return at.position_m[source_.index];
      case Signal::Velocity:
        return at.velocity_m_per_s[source_.index];
      case Signal::VelocityPair:
        return at.velocity_m_per_s[source_.index] + source_.sign * at.velocity_m_per_s[source_.other];
      case Signal::WaySinceReversal:
        return at.since_reversal.way_m;
      case Signal::TimeSinceReversal:
        return at.since_reversal.time_s;
      case Signal::Load:
        return at.load_N;
      case Signal::Pose:
        return at.motion == nullptr ? 0.0 : at.motion->pose[source_.index];
      default:
        return legAngle(at);
    }
  }
  double legAngle(const EffectInstant& at) const noexcept {
    if (at.motion == nullptr) return 0.0;
    const mechanism::JointCoordinates q = mechanism::inverseKinematics(*at.mechanism, at.motion->pose);
    const std::size_t leg = static_cast<std::size_t>(source_.index);
    return source_.index == mechanism::kLegs - 1 ? q.q41 : source_.second ? q.q2[leg] : q.q1[leg];
  }

  const Source source_;
  const Knots knots_;
};

}  // namespace

Law mapLaw(const std::string& depends_on, const Shape& knots) {
  if (Law matrix = platformMatrixLaw(depends_on, knots)) return matrix;
  if (knots.size() < 2 || knots.size() > kMostColumns) return nullptr;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    if (!(knots[k] < knots[k + 1])) return nullptr;
  }
  if (const std::optional<Source> source = sourceOf(depends_on)) return std::make_unique<Map>(*source, knots);
  return platformMapLaw(depends_on, knots);
}

}  // namespace knee_robot::dynamics
