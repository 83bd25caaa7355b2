#include <algorithm>
#include <cmath>

#include "common/on_platform.h"
#include "knee_robot/base/constants.h"

namespace knee_robot::tracing {
namespace {

constexpr double kHeaviest_kg = 40.0;  ///< both legs of a heavy patient
constexpr double kSlowest_Hz = 0.2, kFastest_Hz = 10.0, kLeastDamping = 0.01, kMostDamping = 0.9;
constexpr double kDamping = 0.1;  ///< of the grid
constexpr double kFurthest_m = 0.3;
constexpr double kStiffest_m = 0.005, kStraight_m = 10.0;
constexpr int kNewton = 30;
constexpr double kTurn_rad = 0.5, kAside_m = 0.08, kFrequencyFactor = 1.3, kWideFactor = 1.8;  ///< between neighbours

/// A mass on a spring that stiffens, and a damper: x'' + 2 d w x' + w^2 x (1 + (x/l)^2) = -drive, its support's
/// acceleration. Without the stiffening stepped exactly while the drive stays the same, which kicks it before and after.
class Oscillator {
 public:
  Oscillator(const std::vector<double>& shape, double period_s)
      : omega_(2.0 * kPi * shape[0]),
        damping_(std::min(shape[1], kMostDamping)),
        stiffens_(1.0 / (shape[6] * shape[6])),
        period_s_(period_s),
        step_(oscillationStep(omega_, damping_, period_s)) {}
  /// It has come to rest under this drive.
  void settle(double drive) {
    double x = 0.0;
    for (int k = 0; k < kNewton; ++k)
      x -= (pull(x) + drive) / (omega_ * omega_ * (1.0 + 3.0 * stiffens_ * x * x));
    state_ << x, 0.0;
  }
  void step(double drive) {
    kick();
    const Eigen::Vector2d rest(-drive / (omega_ * omega_), 0.0);
    state_ = rest + step_ * (state_ - rest);
    kick();
  }
  double displacement_m() const { return state_[0]; }
  double acceleration(double drive) const { return -drive - 2.0 * damping_ * omega_ * state_[1] - pull(state_[0]); }

 private:
  double pull(double x) const { return omega_ * omega_ * x * (1.0 + stiffens_ * x * x); }
  void kick() { state_[1] -= 0.5 * period_s_ * omega_ * omega_ * stiffens_ * state_[0] * state_[0] * state_[0]; }

  const double omega_, damping_, stiffens_, period_s_;
  const Eigen::Matrix2d step_;
  Eigen::Vector2d state_;
};

/// The platform at one sample, seen from the point where the mass sits.
struct Support {
  mechanism::Vector3 direction, specific_force;  ///< that a rigid mass there needs per kilogram
  Eigen::Matrix<double, 3, 4> by_pose;           ///< velocity of the point by the pose's rates
  mechanism::Vector3 psi_axis;
};

Support supportAt(const EffectInput& in, std::size_t sample, const std::vector<double>& shape) {
  const mechanism::Matrix3& rotation = in.rotation[sample];
  const mechanism::Vector3 arm = rotation * mechanism::Vector3(shape[2], shape[3], 0.0);
  const double level = std::cos(shape[5]);
  Support out;
  out.psi_axis = rotation.col(2);
  out.by_pose = velocityByPose(rotation, arm);
  out.direction =
      rotation * mechanism::Vector3(level * std::cos(shape[4]), level * std::sin(shape[4]), std::sin(shape[5]));
  out.specific_force = out.by_pose * in.observation->motion.motion[sample].pose_acceleration - in.robot->gravity;
  return out;
}

/// A mass on the platform that gives along one direction: a limb's soft tissue, liquid in a tank, a tool on rubber. Only
/// what it does beyond the same mass held rigidly, which the platform's inertia contains: its own acceleration, and the
/// weight that it shifts.
class WobblingMass : public OnPlatform {
 public:
  std::string name() const override { return "wobbling_mass"; }
  std::string sentence() const override {
    return "A mass on the platform swings along one direction: soft tissue of a limb, liquid in a tank, a tool on "
           "rubber.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"frequency_Hz", kSlowest_Hz, kFastest_Hz},       {"damping_ratio", kLeastDamping, kMostDamping},
            {"platform_x_m", -kFurthest_m, kFurthest_m},      {"platform_y_m", -kFurthest_m, kFurthest_m},
            {"direction_about_z_rad", -2.0 * kPi, 2.0 * kPi}, {"direction_above_xy_rad", -kPi, kPi},
            {"stiffens_within_m", kStiffest_m, kStraight_m}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid;
    for (const std::vector<double>& frequency : geometricGrid(0.4, 6.0, 6)) {
      for (const double stiffens_m : {kStraight_m, 0.05}) {
        for (const double about_z : {0.0, 0.25 * kPi, 0.5 * kPi, 0.75 * kPi})
          grid.push_back({frequency[0], kDamping, 0.0, 0.0, about_z, 0.0, stiffens_m});
        grid.push_back({frequency[0], kDamping, 0.0, 0.0, 0.0, 0.5 * kPi, stiffens_m});
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    return besideEach(s, step, shapeParameters(), [](std::size_t k, double value, double side) {
      if (k == 0) return value * std::pow(kFrequencyFactor, side);
      if (k == 1 || k == 6) return value * std::pow(kWideFactor, side);
      return value + side * (k < 4 ? kAside_m : kTurn_rad);
    });
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"mass_kg", true}}; }
  /// Legs that give under the platform look like a mass of many times its own.
  bool believable(const Eigen::VectorXd& coefficients) const override { return coefficients[0] <= kHeaviest_kg; }

 protected:
  Eigen::Matrix4Xd onPose(const EffectInput& input, const std::vector<double>& shape) const override {
    Oscillator mass(shape, input.signals().period_s);
    Eigen::Matrix4Xd out(4, input.samples());
    for (int n = 0; n < input.samples(); ++n) {
      const std::size_t sample = static_cast<std::size_t>(n);
      const Support at = supportAt(input, sample, shape);
      const double drive = at.direction.dot(at.specific_force);
      n == 0 ? mass.settle(drive) : mass.step(drive);
      const mechanism::Vector3 shifted = (mass.displacement_m() * at.direction).cross(at.specific_force);
      out.col(n) = at.by_pose.transpose() * (mass.acceleration(drive) * at.direction);
      out(2, n) += shifted.y();
      out(3, n) += shifted.dot(at.psi_axis);
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeWobblingMass() {
  return std::make_unique<WobblingMass>();
}

}  // namespace knee_robot::tracing
