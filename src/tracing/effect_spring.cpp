#include "effects.h"
#include "line_between.h"

namespace knee_robot::tracing {
namespace {

/// A straight spring between a point of the base and a point of the platform: force k (d - d0) along their distance d. Stiffness and
/// k d0 are linear; where it is anchored is searched. Heights are left at 0: to first order they are a change of d0.
class Spring : public Candidate {
 public:
  std::string name() const override { return "spring"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "A spring acts between a point of the base and a point of the platform: its force grows with their "
           "distance.";
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
    return {{"stiffness_N_per_m", true}, {"stiffness_times_free_length_N", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const LineForces line = lineForces(input, actuator, anchorsOf(shape));
    Eigen::MatrixXd out(input.samples(), 2);
    out.col(0) = line.lever.cwiseProduct(line.length_m);
    out.col(1) = -line.lever;
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeSpring() {
  return std::make_unique<Spring>();
}

}  // namespace knee_robot::tracing
