#include "common/push_window.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// A push on the platform: constant force and moments (it need not go through the origin) during part of one training
/// recording.
class ExternalForce : public PushWindow {
 public:
  std::string sentence() const override {
    return "Something pushed the platform during part of one recording; this cannot happen again in another one.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"force_x_N", false}, {"force_z_N", false}, {"moment_theta_N_m", false}, {"moment_psi_N_m", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), 4);
    if (input.recording + 1 != static_cast<int>(shape[0])) return out;
    const Samples window = samplesOf(input, actuator, shape);
    for (int n = window.begin; n < window.end; ++n)
      out.row(n) = -input.force_per_pose_force[static_cast<std::size_t>(n)].row(actuator);
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeExternalForce() {
  return std::make_unique<ExternalForce>();
}

}  // namespace knee_robot::tracing
