#include "effects.h"

namespace knee_robot::tracing {
namespace {

/// A potential of second order in the pose, V = f x + x' K x / 2: what any spring between base and platform looks like near the
/// middle of the workspace, wherever it is anchored. Ten entries of K, and the constant force on each coordinate.
class Spring : public Candidate {
 public:
  std::string name() const override { return "spring"; }
  std::string sentence() const override {
    return "A spring acts between base and platform: the force is the gradient of a potential of the pose.";
  }
  bool shared() const override { return true; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    static const char* const kNames[] = {"x", "z", "theta", "psi"};
    std::vector<Coefficient> out;
    for (int i = 0; i < 4; ++i) {
      for (int k = i; k < 4; ++k)
        out.push_back({std::string("stiffness_") + kNames[i] + "_" + kNames[k] + "_SI", false});
    }
    for (const char* name : kNames)
      out.push_back({std::string("force_") + name + "_SI", false});
    return out;
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    Eigen::MatrixXd out(input.samples(), 14);
    for (int n = 0; n < input.samples(); ++n) {
      const std::size_t sample = static_cast<std::size_t>(n);
      const mechanism::Vector4 lever = input.force_per_pose_force[sample].row(actuator).transpose();
      const mechanism::Pose& x = input.observation->motion.motion[sample].pose;
      int column = 0;
      for (int i = 0; i < 4; ++i) {
        for (int k = i; k < 4; ++k)
          out(n, column++) = lever[i] * x[k] + (k > i ? lever[k] * x[i] : 0.0);
      }
      out.row(n).tail<4>() = lever.transpose();
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeSpring() {
  return std::make_unique<Spring>();
}

}  // namespace knee_robot::tracing
