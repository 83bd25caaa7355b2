#include <algorithm>
#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kGentlestPower = 1.3, kSharpestPower = 5.0;
constexpr double kPowerBeside = 1.4;      ///< factor between neighbours
constexpr double kSaturatesAt_N = 100.0;  ///< where it is said how much is lost
constexpr double kMostToldMore = 1.0;     ///< there

/// A motor whose force falls short the more, the more of it is asked for: its iron saturates (the force constant, or
/// torque constant, droops), or its amplifier's supply is soft.
class MotorSaturation : public Candidate {
 public:
  std::string name() const override { return "motor_saturation"; }
  bool ofDrive() const override { return true; }
  std::string sentence() const override {
    return "The drive falls short of what it is told by a share that grows with the force: its motor saturates.";
  }
  bool worksOn(const mechanism::Robot& robot) const override { return !robot.chain; }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"power", kGentlestPower, kSharpestPower}}; }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override { return {{2.0}, {3.0}}; }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double factor : {std::pow(kPowerBeside, -step), std::pow(kPowerBeside, step)})
      out.push_back({std::clamp(s[0] * factor, kGentlestPower, kSharpestPower)});
    return out;
  }
  /// Where the motion needs 100 N, the drive has to be told 1 + c times as much.
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"told_more_by_at_100_N", true}}; }
  bool plausible(const Eigen::VectorXd& coefficients) const override { return coefficients[0] < kMostToldMore; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const Eigen::ArrayXd needed_N = input.needed_N.col(actuator).array();
    return needed_N * (needed_N.abs() / kSaturatesAt_N).pow(shape[0] - 1.0);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeMotorSaturation() {
  return std::make_unique<MotorSaturation>();
}

}  // namespace knee_robot::tracing
