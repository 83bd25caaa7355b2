#include <algorithm>
#include <cmath>

#include "common/driven_load.h"
#include "common/yielding_coupling.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSoftestCoupling = 4e3, kStiffestCoupling = 5e5;  ///< N/m
constexpr int kStiffnesses = 8;
constexpr double kLeastCouplingDamping = 0.01, kMostCouplingDamping = 0.6, kCouplingDamping = 0.1,
                 kDampingOfOlder = 0.05;

class FlexibleCoupling : public Candidate {
 public:
  std::string name() const override { return "flexible_coupling"; }
  bool actsFast() const override { return true; }
  bool reachesOthers() const override { return true; }
  std::string sentence() const override {
    return "Motor and screw are joined elastically: after each reversal the joint winds up before the screw follows, "
           "and "
           "the platform hangs and swings on it, which the other legs feel.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"stiffness_N_per_m", kSoftestCoupling, kStiffestCoupling},
            frictionBeyondParameter(),
            {"damping_ratio", kLeastCouplingDamping, kMostCouplingDamping, false, kDampingOfOlder}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return withLast(withLast(geometricGrid(kSoftestCoupling, kStiffestCoupling, kStiffnesses), {1.0, 0.5, 0.0}),
                    {kCouplingDamping});
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out = besideJoint(shape, step, shapeParameters());
    for (const double sign : {-1.0, 1.0}) {
      out.push_back(shape);
      out.back()[2] = std::clamp(shape[2] * std::pow(1.8, sign * step), kLeastCouplingDamping, kMostCouplingDamping);
    }
    return out;
  }
  std::vector<double> ofSize(const std::vector<double>& shape, double times) const override {
    return {std::clamp(shape[0] / times, kSoftestCoupling, kStiffestCoupling), shape[1], shape[2]};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"share_of_forward_model", true}};
  }
  bool plausible(const Eigen::VectorXd& c) const override { return c[0] > 0.5 && c[0] < 1.6; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    return reach(input, actuator, shape)[static_cast<std::size_t>(actuator)];
  }
  std::vector<Eigen::MatrixXd> reach(const EffectInput& input, int actuator,
                                     const std::vector<double>& shape) const override {
    const Eigen::MatrixXd change = changeByCoupling(input, actuator, {shape[0], shape[1], shape[2]});
    std::vector<Eigen::MatrixXd> out;
    for (int i = 0; i < input.axes(); ++i)
      out.push_back(change.col(i));
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeFlexibleCoupling() {
  return std::make_unique<FlexibleCoupling>();
}

}  // namespace knee_robot::tracing
