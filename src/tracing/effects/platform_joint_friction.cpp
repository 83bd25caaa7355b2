#include <algorithm>
#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSteepest = 5e-4, kFlattest = 0.2;  ///< rad/s
constexpr double kSpeedFactor = 2.0;

/// Friction of the joints between legs and platform. The baseline has that of the joints at the base alone (eq. (23));
/// in a virtual plant of the paper's robot it is what the rigid model misses most (Table 4).
class PlatformJointFriction : public Candidate {
 public:
  std::string name() const override { return "platform_joint_friction"; }
  bool restsOnModel() const override { return false; }
  bool shared() const override { return true; }
  std::string sentence() const override {
    return "The joints between the legs and the platform rub: the universal joint of leg 4 and the spherical joints of "
           "legs 1 to 3.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"smooth_below_rad_per_s", kSteepest, kFlattest}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return geometricGrid(0.002, 0.05, 3);
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    const double factor = std::pow(kSpeedFactor, step);
    return {{std::max(kSteepest, s[0] / factor)}, {std::min(kFlattest, s[0] * factor)}};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"leg_4_about_y_coulomb_N_m", true},    {"leg_4_about_y_viscous_N_m_s_per_rad", true},
            {"leg_4_about_psi_coulomb_N_m", true},  {"leg_4_about_psi_viscous_N_m_s_per_rad", true},
            {"spherical_joints_coulomb_N_m", true}, {"spherical_joints_viscous_N_m_s_per_rad", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    dynamics::PoseColumns on_pose;
    Eigen::MatrixXd out(input.samples(), dynamics::kPlatformJointColumns);
    for (int n = 0; n < input.samples(); ++n) {
      const std::size_t sample = static_cast<std::size_t>(n);
      dynamics::platformJointColumns(input.platform_joints[sample],
                                     input.observation->motion.motion[sample].pose_velocity, shape[0], on_pose);
      out.row(n) = input.force_per_pose_force[sample].row(actuator) * on_pose.leftCols(out.cols());
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makePlatformJointFriction() {
  return std::make_unique<PlatformJointFriction>();
}

}  // namespace knee_robot::tracing
