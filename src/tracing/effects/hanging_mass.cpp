#include <algorithm>
#include <cmath>

#include "common/on_platform.h"
#include "knee_robot/base/constants.h"

namespace knee_robot::tracing {
namespace {

constexpr double kHeaviest_kg = 40.0;
constexpr double kSlowest_Hz = 0.3, kFastest_Hz = 3.0;  ///< a pendulum of 2.8 m, of 3 cm
constexpr double kLeastDamping = 0.002, kMostDamping = 0.7, kDamping = 0.05;
constexpr double kFurthest_m = 0.4, kAside_m = 0.1, kFrequencyFactor = 1.2,
                 kDampingFactor = 1.8;  ///< between neighbours
constexpr int kFrequencies = 8;

/// Where a mass hangs, relative to straight below its pivot, and its velocity: to both sides alike. Stepped exactly while
/// what drives it stays the same.
class Pendulum {
 public:
  Pendulum(double frequency_Hz, double damping, double period_s)
      : omega_(kTwoPi * frequency_Hz),
        damping_(std::min(damping, kMostDamping)),
        step_(oscillationStep(omega_, damping_, period_s)) {}
  /// `aside`: horizontal acceleration of the pivot; `heavier`: how much heavier than at rest what hangs there is, as a
  /// share.
  void step(const mechanism::Vector3& aside, double heavier) {
    const Eigen::RowVector3d rest = -drive(aside, heavier).transpose() / (omega_ * omega_);
    state_.row(0) -= rest;
    state_ = (step_ * state_).eval();
    state_.row(0) += rest;
  }
  /// Of the mass, relative to its pivot.
  mechanism::Vector3 acceleration(const mechanism::Vector3& aside, double heavier) const {
    return -drive(aside, heavier) - 2.0 * damping_ * omega_ * state_.row(1).transpose() -
           omega_ * omega_ * state_.row(0).transpose();
  }

 private:
  mechanism::Vector3 drive(const mechanism::Vector3& aside, double heavier) const {
    return aside + heavier * omega_ * omega_ * state_.row(0).transpose();
  }

  const double omega_, damping_;
  const Eigen::Matrix2d step_;
  Eigen::Matrix<double, 2, 3> state_ = Eigen::Matrix<double, 2, 3>::Zero();  ///< place, velocity
};

/// A mass that hangs from the platform by a rope or a joint and swings to all sides: a hose, a bag, a lower leg. Only what
/// it does beyond the same mass held rigidly at the pivot, which the platform's inertia contains. Small angles.
class HangingMass : public OnPlatform {
 public:
  std::string name() const override { return "hanging_mass"; }
  std::string sentence() const override {
    return "A mass on the platform swings to all sides alike: it hangs like a pendulum (a bag, a hose, a limb), or "
           "lies "
           "on something soft.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"frequency_Hz", kSlowest_Hz, kFastest_Hz},
            {"damping_ratio", kLeastDamping, kMostDamping},
            {"platform_x_m", -kFurthest_m, kFurthest_m},
            {"platform_y_m", -kFurthest_m, kFurthest_m},
            {"platform_z_m", -kFurthest_m, kFurthest_m}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid = geometricGrid(0.4, 2.5, kFrequencies);
    for (std::vector<double>& shape : grid)
      shape.insert(shape.end(), {kDamping, 0.0, 0.0, 0.0});
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    return besideEach(s, step, shapeParameters(), [](std::size_t k, double value, double side) {
      if (k == 0) return value * std::pow(kFrequencyFactor, side);
      if (k == 1) return value * std::pow(kDampingFactor, side);
      return value + side * kAside_m;
    });
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"mass_kg", true}}; }
  bool believable(const Eigen::VectorXd& coefficients) const override { return coefficients[0] <= kHeaviest_kg; }

 protected:
  Eigen::Matrix4Xd onPose(const EffectInput& input, const std::vector<double>& shape) const override {
    Pendulum mass(shape[0], shape[1], input.signals().period_s);
    const double gravity = input.robot->gravity.norm();
    const mechanism::Vector3 up = -input.robot->gravity / gravity;
    Eigen::Matrix4Xd out(4, input.samples());
    for (int n = 0; n < input.samples(); ++n) {
      const std::size_t sample = static_cast<std::size_t>(n);
      const mechanism::Matrix3& rotation = input.rotation[sample];
      const mechanism::Vector3 arm = rotation * mechanism::Vector3(shape[2], shape[3], shape[4]);
      const Eigen::Matrix<double, 3, 4> by_pose = velocityByPose(rotation, arm);
      const mechanism::Vector3 moves = by_pose * input.observation->motion.motion[sample].pose_acceleration;
      const double rises = up.dot(moves);
      const mechanism::Vector3 aside = moves - rises * up;
      if (n > 0) mass.step(aside, rises / gravity);
      out.col(n) = by_pose.transpose() * mass.acceleration(aside, rises / gravity);
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeHangingMass() {
  return std::make_unique<HangingMass>();
}

}  // namespace knee_robot::tracing
