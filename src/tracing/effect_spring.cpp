#include "effects.h"

namespace knee_robot {
namespace {

/// A smooth potential of the pose: stiffness along X and Z and about theta and psi, and the constant force that sets its rest.
class Spring : public Candidate {
 public:
  std::string name() const override { return "spring"; }
  std::string sentence() const override {
    return "A spring acts between base and platform: the force depends on the pose, not on the motion.";
  }
  bool shared() const override { return true; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"stiffness_x_N_per_m", true},
            {"stiffness_z_N_per_m", true},
            {"stiffness_theta_N_m_per_rad", true},
            {"stiffness_psi_N_m_per_rad", true},
            {"force_x_N", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    Eigen::MatrixXd out(input.samples(), 5);
    for (int n = 0; n < input.samples(); ++n) {
      const std::size_t i = static_cast<std::size_t>(n);
      const auto lever = input.force_per_pose_force[i].row(actuator);
      out.row(n).head<4>() = lever.cwiseProduct(input.observation->motion.motion[i].pose.transpose());
      out(n, 4) = lever[0];
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeSpring() {
  return std::make_unique<Spring>();
}

}  // namespace knee_robot
