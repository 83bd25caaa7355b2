#include <algorithm>
#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kNarrowest_rad = 0.02, kWidest_rad = 1.0;
constexpr double kWidths_rad[] = {0.05, 0.1, 0.2};  ///< to begin with
constexpr double kJointFactor = 1.5;                ///< of refinement
constexpr int kTheta = 2, kPsi = 3;                 ///< coordinates of the pose

/// A limb's joint that turns with the platform: its passive moment grows exponentially towards both ends of its range
/// (Riener and Edrich, J. Biomechanics 32, 1999).
class PassiveJoint : public Candidate {
 public:
  std::string name() const override { return "passive_joint"; }
  std::string sentence() const override {
    return "A joint of whoever is on the platform turns with it and resists more and more, exponentially, towards the "
           "ends of its range.";
  }
  bool shared() const override { return true; }
  bool isForceField() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"coordinate", kTheta, kPsi, true}, {"width_rad", kNarrowest_rad, kWidest_rad}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> out;
    for (const int coordinate : {kTheta, kPsi}) {
      for (const double width : kWidths_rad)
        out.push_back({static_cast<double>(coordinate), width});
    }
    return out;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double side : {-step, step})
      out.push_back({shape[0], std::clamp(shape[1] * std::pow(kJointFactor, side), kNarrowest_rad, kWidest_rad)});
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"towards_positive_Nm", true}, {"towards_negative_Nm", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& in, int actuator, const std::vector<double>& shape) const override {
    const int coordinate = shape[0] < 0.5 * (kTheta + kPsi) ? kTheta : kPsi;
    Eigen::MatrixXd out(in.samples(), 2);
    for (int n = 0; n < in.samples(); ++n) {
      const std::size_t sample = static_cast<std::size_t>(n);
      const double lever = in.force_per_pose_force[sample](actuator, coordinate);
      const double turned = in.observation->motion.motion[sample].pose[coordinate] / shape[1];
      out.row(n) << lever * std::exp(turned), -lever * std::exp(-turned);
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makePassiveJoint() {
  return std::make_unique<PassiveJoint>();
}

}  // namespace knee_robot::tracing
