#include "common/line_effect.h"

namespace knee_robot::tracing {
namespace {

constexpr double kMiddle_m = 0.7;  ///< about which the powers are taken: lengths of this kind of robot

/// A cable, a strap or a limb between a point of the base and a point of the platform: its force is a curve over their
/// distance, of third order, so that it may harden, soften or hang slack at one end.
class NonlinearSpring : public LineEffect {
 public:
  std::string name() const override { return "nonlinear_spring"; }
  std::string generalizes() const override { return "spring"; }
  std::string sentence() const override {
    return "A cable, a strap or a limb acts between a point of the base and a point of the platform: its force is a "
           "curve over their distance.";
  }
  bool isForceField() const override { return true; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"force_at_0.7_m_N", false},
            {"stiffness_N_per_m", false},
            {"quadratic_N_per_m2", false},
            {"cubic_N_per_m3", false}};
  }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>&) const override {
    const Eigen::VectorXd beyond = line.length_m.array() - kMiddle_m;
    Eigen::MatrixXd out(beyond.size(), 4);
    out.col(0).setOnes();
    for (Eigen::Index power = 1; power < out.cols(); ++power)
      out.col(power) = out.col(power - 1).cwiseProduct(beyond);
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeNonlinearSpring() {
  return std::make_unique<NonlinearSpring>();
}

}  // namespace knee_robot::tracing
