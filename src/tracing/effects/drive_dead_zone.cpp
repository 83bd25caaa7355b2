#include <algorithm>
#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSteepest_N = 0.1, kFlattest_N = 20.0;  ///< over which what is lost comes up
constexpr double kBeside = 2.0;                          ///< factor between neighbours
constexpr int kSteps = 10;  ///< refinement goes by half of it on either side, and so from one to the next

/// Around zero a drive gives less force than it is told to (dead time of a bridge, a dead zone of an amplifier): beyond,
/// every command is larger by as much.
class DriveDeadZone : public Candidate {
 public:
  std::string name() const override { return "drive_dead_zone"; }
  bool ofDrive() const override { return true; }
  std::string sentence() const override {
    return "The drive gives nothing for small commands, and less by as much for larger ones: an amplifier's dead zone.";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"over_N", kSteepest_N, kFlattest_N}}; }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return geometricGrid(kSteepest_N, kFlattest_N, kSteps);
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double factor : {std::pow(kBeside, -step), std::pow(kBeside, step)})
      out.push_back({std::clamp(s[0] * factor, kSteepest_N, kFlattest_N)});
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"lost_N", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    return (input.needed_N.col(actuator).array() / shape[0]).tanh();
  }
};

}  // namespace

std::unique_ptr<Candidate> makeDriveDeadZone() {
  return std::make_unique<DriveDeadZone>();
}

}  // namespace knee_robot::tracing
