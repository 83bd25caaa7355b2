#include <algorithm>
#include <cmath>

#include "common/yielding.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kNarrowest_rad = 0.02, kWidest_rad = 1.0;
constexpr double kWidths_rad[] = {0.05, 0.1, 0.2};  ///< to begin with
constexpr double kYields_rad[] = {0.02, 0.06};      ///< to begin with
constexpr double kShortestYield_rad = 0.002, kLongestYield_rad = 0.5, kOldYield_rad = 0.05;
constexpr double kJointFactor = 1.5;  ///< of refinement
constexpr int kTheta = 2, kPsi = 3;   ///< coordinates of the pose

/// A limb's joint that turns with the platform: its passive moment grows exponentially towards both ends of its range
/// (Riener and Edrich, J. Biomechanics 32, 1999), its tissue damps and yields.
class PassiveJoint : public Candidate {
 public:
  std::string name() const override { return "passive_joint"; }
  std::string sentence() const override {
    return "A joint of whoever is on the platform turns with it: it damps, yields, and resists more and more, "
           "exponentially, towards the ends of its range.";
  }
  bool shared() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"coordinate", kTheta, kPsi, true},
            {"width_rad", kNarrowest_rad, kWidest_rad},
            {"yield_rad", kShortestYield_rad, kLongestYield_rad, false, kOldYield_rad}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> out;
    for (const int coordinate : {kTheta, kPsi}) {
      for (const double width : kWidths_rad) {
        for (const double yield : kYields_rad)
          out.push_back({static_cast<double>(coordinate), width, yield});
      }
    }
    return out;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double factor : {std::pow(kJointFactor, -step), std::pow(kJointFactor, step)}) {
      out.push_back({shape[0], std::clamp(shape[1] * factor, kNarrowest_rad, kWidest_rad), shape[2]});
      out.push_back({shape[0], shape[1], std::clamp(shape[2] * factor, kShortestYield_rad, kLongestYield_rad)});
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"towards_positive_Nm", true},
            {"towards_negative_Nm", true},
            {"damping_Nm_s_per_rad", true},
            {"yield_Nm", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& in, int actuator, const std::vector<double>& shape) const override {
    const int coordinate = shape[0] < 0.5 * (kTheta + kPsi) ? kTheta : kPsi;
    Eigen::VectorXd turned_rad(in.samples()), rate(in.samples()), way_rad(in.samples());
    for (int n = 0; n < in.samples(); ++n) {
      const mechanism::Motion& motion = in.observation->motion.motion[static_cast<std::size_t>(n)];
      turned_rad[n] = motion.pose[coordinate];
      rate[n] = motion.pose_velocity[coordinate];
      way_rad[n] = n > 0 ? rate[n] * (in.time(n) - in.time(n - 1)) : 0.0;
    }
    const Eigen::VectorXd yielded = yieldedShare(way_rad, shape[2]);
    Eigen::MatrixXd out(in.samples(), 4);
    for (int n = 0; n < in.samples(); ++n) {
      const double lever = in.force_per_pose_force[static_cast<std::size_t>(n)](actuator, coordinate),
                   grown = std::exp(turned_rad[n] / shape[1]);
      out.row(n) << lever * grown, -lever / grown, lever * rate[n], lever * yielded[n];
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makePassiveJoint() {
  return std::make_unique<PassiveJoint>();
}

}  // namespace knee_robot::tracing
