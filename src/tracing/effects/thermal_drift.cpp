#include "common/rest_law.h"
#include "common/warm_up.h"

namespace knee_robot::tracing {
namespace {

constexpr int kLevelsOff = 3;  ///< of the shape

/// Friction that changes as the drive warms up from the start of the recording.
class ThermalDrift : public WarmUp {
 public:
  std::string name() const override { return "thermal_drift"; }
  bool isFriction() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Friction changes while the drive warms up, with a time constant, from the start of each recording; not all "
           "begin equally warm.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out = WarmUp::shapeParameters();
    out.push_back({"levels_off", 0.0, kMostLevelling, false, 0.0});
    out.push_back(restLawParameter());
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    std::vector<std::vector<double>> grid = WarmUp::shapes(input, actuator);
    for (std::vector<double>& shape : grid)
      shape.push_back(0.0);
    return withRestLaws(grid);
  }
  int levelsOff() const override { return kLevelsOff; }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out = besideRestLaw(shape, step);
    for (const std::vector<double>& other : WarmUp::near(shape, step))
      out.push_back(other);
    return out;
  }

 protected:
  std::vector<std::string> changes() const override { return {"coulomb_change_N", "viscous_change_N_s_per_m"}; }
  Eigen::MatrixXd changing(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out(input.samples(), 2);
    out << rubbingShare(input, actuator, shape), input.signals().velocity_m_per_s.col(actuator);
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeThermalDrift() {
  return std::make_unique<ThermalDrift>();
}

}  // namespace knee_robot::tracing
