#pragma once

#include <array>
#include <string>
#include <tuple>
#include <vector>

namespace knee_robot::dynamics {

/// How one part of dry friction builds up near rest.
enum class FrictionKind {
  Stop,      ///< with the way since the last reversal, up to a width (stop operator of Prandtl); rest keeps what it was
  Smooth,    ///< with velocity, as its SmoothShape says; none at rest
  Bristles,  ///< bend over a width (Dahl; LuGre without its Stribeck curve) and slip back at a creep speed
};

/// How a smooth law rises with x = v / speed (x > 0; odd).
enum class SmoothShape {
  Tanh,        ///< tanh(x)
  Ramp,        ///< x up to the speed, 1 beyond it (saturation)
  Rational,    ///< x / (1 + x): full only far beyond the speed
  Root,        ///< x / sqrt(1 + x^2)
  Arctangent,  ///< 2/pi atan(x)
};

/// One part of the law of one actuator.
///
/// A stop may lie behind a clearance: it is bent by what is beyond `gap_m`, so that after a reversal nothing presses
/// until that is crossed. One that relaxes lets go of what it holds with the time constant `relaxation_s`, in motion and at
/// rest (a Maxwell element that slips).
///
/// A smooth law of tanh may lag: with `lag_s` it is tanh of the velocity that a first-order lag leaves (frictional lag of
/// a lubricant film that follows late; Hess and Soom 1990).
///
/// Bristles: with the way r = sqrt(dx^2 + (creep dt)^2), the share follows dz = (dx - r z) / width. Creep speed 0 is
/// Dahl's model; at rest the share decays with the time width / creep (an axis that trembles by less than its encoder
/// shows lets go of its bristles). Where that tremble is seen, as way of the encoder beyond the motion's own, a share
/// of it slips them as well: with `tremble` 1 bristles slip by all of the way that the encoder shows. What they press
/// is z + damping dz/dt, the micro-damping of LuGre. An exponent other than 1 (Dahl 1968: below it for brittle, above
/// it for ductile contacts) makes it dz = (1 - z sign(dx))^exponent dx / width, without creep and tremble.
struct FrictionElement {
  FrictionKind kind = FrictionKind::Stop;
  double share = 1.0;  ///< of the actuator's Coulomb friction; below 0: taken away from the others (a peak near rest)
  double width_m = 1e-5;       ///< Stop, Bristles
  double speed_m_per_s = 0.0;  ///< Smooth: of its shape; Bristles: creep
  double damping_s = 0.0;      ///< Bristles
  double tremble = 0.0;        ///< Bristles: share of the encoder's tremble that slips them
  double exponent = 1.0;       ///< Bristles without creep and tremble: Dahl's
  double gap_m = 0.0;          ///< Stop: way in its middle over which nothing presses
  double relaxation_s = 0.0;   ///< Stop: time in which it lets go of what it holds; 0: never
  double lag_s = 0.0;          ///< Smooth: time constant with which it follows the velocity
  SmoothShape smooth = SmoothShape::Tanh;

  /// All but the share.
  auto shape() const {
    return std::make_tuple(kind, width_m, speed_m_per_s, damping_s, tremble, exponent, gap_m, relaxation_s, lag_s,
                           smooth);
  }
  bool operator==(const FrictionElement& o) const { return share == o.share && shape() == o.shape(); }
};

inline constexpr int kMostFrictionElements = 8;

/// Law of friction near rest of one actuator: which share of full Coulomb friction acts, in [-1, 1] or, where it has a
/// peak, by as much beyond. A sum of elements whose shares add up to 1: a spectrum of stops (Prandtl-Ishlinskii, Maxwell
/// slip), smooth laws, bristles, or a mixture. Away from rest every law is sign(v). Fixed size: a real-time program may
/// copy it.
struct FrictionLaw {
  std::array<FrictionElement, kMostFrictionElements> elements{};
  int count = 1;
  bool revolute = false;  ///< of a revolute joint, counted at mechanism::kJointRadius_m: described in rad
  /// Share that elements which remember (stops, bristles) hold when a recording begins at rest, in [-1, 1]: part
  /// of that of the training recordings, where they agree (identification/loaded_start). A robot at work does not begin
  /// so; controllers do not look at it.
  double at_start = 0.0;

  bool operator==(const FrictionLaw& o) const;
  bool operator!=(const FrictionLaw& o) const { return !(*this == o); }
};

FrictionLaw stopLaw(double width_m);
FrictionLaw smoothLaw(double speed_m_per_s, SmoothShape shape = SmoothShape::Tanh);
FrictionLaw bristleLaw(double width_m, double creep_m_per_s = 0.0, double damping_s = 0.0, double tremble = 0.0);

/// The law of these elements, shares brought to a sum of 1. std::invalid_argument when there are none or too many, or a
/// sum is 0.
FrictionLaw lawOf(const std::vector<FrictionElement>& elements);

/// Sum of the shares that are taken away from the others; 0: friction is nowhere larger than beyond rest.
double peakOf(const FrictionLaw& law);

/// "one stop", "tanh of velocity", "bristles (Dahl)", "creeping bristles", "two stops", "spectrum of stops", "mixture",
/// "tanh of lagging velocity", "ramp of velocity", "rational law of velocity", "root law of velocity",
/// "arctangent of velocity", "peak near rest".
std::string nameOf(const FrictionLaw& law);
/// As files name it: "tanh", "ramp", "rational", "root", "arctangent".
const char* smoothName(SmoothShape shape);
/// With numbers: "stop 9 um (61 %) + stop 100 um (39 %)".
std::string describe(const FrictionLaw& law);

/// The memory of one actuator's friction. Real-time safe.
class FrictionState {
 public:
  /// Moves by `displacement_m` within `duration_s` (positive), trembling by so much way a second beside it; returns the
  /// new share of full Coulomb friction.
  double step(const FrictionLaw& law, double displacement_m, double duration_s, double tremble_m_per_s = 0.0) noexcept;
  /// All that remembers starts with this share in [-1, 1].
  void start(double share) noexcept { z_.fill(share); }
  /// Lets go of this share of what is remembered, as an axis at rest does when the force that bent its bristles is
  /// taken away.
  void fade(double factor) noexcept {
    for (double& z : z_)
      z *= factor;
  }

 private:
  std::array<double, kMostFrictionElements> z_{};
};

}  // namespace knee_robot::dynamics
