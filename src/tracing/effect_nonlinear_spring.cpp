#include "effects.h"
#include "line_between.h"

namespace knee_robot::tracing {
namespace {

constexpr double kMiddle_m = 0.7;  ///< about which the powers are taken: lengths of this kind of robot

/// A cable, a strap or a limb between a point of the base and a point of the platform: its force is a curve over their distance, of third order,
/// so that it may harden, soften or hang slack at one end. Heights of the points are left at 0.
class NonlinearSpring : public Candidate {
 public:
  std::string name() const override { return "nonlinear_spring"; }
  std::string generalizes() const override { return "spring"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "A cable, a strap or a limb acts between a point of the base and a point of the platform: its force is a "
           "curve over their distance.";
  }
  bool shared() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out;
    for (const char* name : kAnchorNames)
      out.push_back({name, -1.0, 1.0});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int) const override {
    return anchorGrid(*input.robot);
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    return anchorsNear(s, step);
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"force_at_0.7_m_N", false},
            {"stiffness_N_per_m", false},
            {"quadratic_N_per_m2", false},
            {"cubic_N_per_m3", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const LineForces line = lineForces(input, actuator, anchorsOf(shape));
    const Eigen::VectorXd beyond = line.length_m.array() - kMiddle_m;
    Eigen::MatrixXd out(input.samples(), 4);
    out.col(0) = line.lever;
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
