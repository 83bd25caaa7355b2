#include <algorithm>
#include <cmath>

#include "common/reflex.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// Places in the shape.
enum JointReflexShape : std::size_t { kJointCoordinate, kJointThreshold, kJointDelay, kJointDecay, kJointStretch };
constexpr int kAboutTheta = 2, kAboutPsi = 3;  ///< coordinates of the pose
constexpr double kThresholdsAbout[] = {0.05, 0.2}, kStretchesAbout[] = {0.03, 0.2}, kDecaysAbout[] = {0.1, 0.5};
constexpr double kDelayAbout_s = 0.05, kJointReflexFactor = 1.6;

/// A joint of whoever is on the platform turns with it, and its muscles answer being stretched fast: late, against the
/// turning, letting go slowly. Those that rising stretches and those that falling stretches have a moment of their own.
class JointStretchReflex : public Candidate {
 public:
  std::string name() const override { return "joint_stretch_reflex"; }
  std::string sentence() const override {
    return "Muscles about a joint of whoever is on the platform resist, late, when they are stretched fast (a spastic "
           "catch), and let go slowly.";
  }
  bool shared() const override { return true; }
  bool restsOnModel() const override { return false; }
  bool needsTwoRecordings() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"coordinate", kAboutTheta, kAboutPsi, true},
            {"threshold_rad_per_s", 0.02, 2.0},
            {"delay_s", 0.005, 0.2},
            {"decay_s", 0.05, 5.0},
            {"stretch_rad", 0.002, 1.0}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid;
    for (const int coordinate : {kAboutTheta, kAboutPsi}) {
      for (const double threshold : kThresholdsAbout) {
        for (const double decay_s : kDecaysAbout) {
          for (const double stretch : kStretchesAbout)
            grid.push_back({static_cast<double>(coordinate), threshold, kDelayAbout_s, decay_s, stretch});
        }
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out;
    const std::vector<ShapeParameter> limits = shapeParameters();
    for (std::size_t k = kJointThreshold; k <= kJointStretch; ++k) {
      for (const double sign : {-1.0, 1.0}) {
        out.push_back(shape);
        out.back()[k] = std::clamp(shape[k] * std::pow(kJointReflexFactor, sign * step), limits[k].low, limits[k].high);
      }
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"against_rising_Nm", true}, {"against_falling_Nm", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& in, int actuator, const std::vector<double>& shape) const override {
    const int coordinate = shape[kJointCoordinate] < 0.5 * (kAboutTheta + kAboutPsi) ? kAboutTheta : kAboutPsi;
    Eigen::VectorXd rate(in.samples()), lever(in.samples());
    for (int n = 0; n < in.samples(); ++n) {
      const std::size_t at = static_cast<std::size_t>(n);
      rate[n] = in.observation->motion.motion[at].pose_velocity[coordinate];
      lever[n] = in.force_per_pose_force[at](actuator, coordinate);
    }
    const Reflex reflex = {shape[kJointThreshold], shape[kJointDelay], shape[kJointDecay], shape[kJointStretch]};
    const double period_s = in.signals().period_s;
    Eigen::MatrixXd out(in.samples(), 2);
    out.col(0) = lever.cwiseProduct(reflexActivation(rate, period_s, reflex));
    out.col(1) = -lever.cwiseProduct(reflexActivation(-rate, period_s, reflex));
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeJointStretchReflex() {
  return std::make_unique<JointStretchReflex>();
}

}  // namespace knee_robot::tracing
