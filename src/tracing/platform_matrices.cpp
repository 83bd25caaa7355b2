#include "platform_matrices.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr int kPoseSize = 4;
constexpr double kFastestWay_s = 0.05, kSlowestWay_s = 30.0;
constexpr double kWayTimes_s[] = {0.3, 1.0, 4.0};  ///< to begin with
constexpr double kWayFactor = 1.5;                 ///< between neighbours
constexpr const char* kOverVelocity = "platform_velocity";
constexpr const char* kOverWay = "platform_way_of_late";

/// 16 coefficients: rows of forces and moments, columns of x, z, theta and psi.
class PlatformMatrix : public Candidate {
 public:
  explicit PlatformMatrix(bool relaxes) : relaxes_(relaxes) {}

  std::string name() const override { return "unnamed"; }
  bool isMap() const override { return true; }
  bool shared() const override { return true; }
  double leastFloors() const override { return 2.0; }
  std::string generalizes() const override { return relaxes_ ? "viscoelastic_link" : "dashpot"; }
  bool restsOnModel() const override { return false; }
  std::string dependsOn(int) const override { return relaxes_ ? kOverWay : kOverVelocity; }
  std::string sentence() const override {
    return std::string("No named effect fits; force and moment on the platform follow ") +
           (relaxes_ ? "the way that it went of late, as springs that relax"
                     : "its velocity, as dampers, or a wheel that spins on it,") +
           " in several directions would (" + dependsOn(0) + ").";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    if (!relaxes_) return {};
    return {{"relaxation_s", kFastestWay_s, kSlowestWay_s}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    if (!relaxes_) return {{}};
    std::vector<std::vector<double>> grid;
    for (const double time : kWayTimes_s)
      grid.push_back({time});
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double side : {-step, step}) {
      if (relaxes_) out.push_back({std::clamp(shape[0] * std::pow(kWayFactor, side), kFastestWay_s, kSlowestWay_s)});
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override;
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override;

 private:
  const bool relaxes_;
};

std::vector<Coefficient> PlatformMatrix::coefficients(const EffectInput&) const {
  constexpr std::array<const char*, kPoseSize> kForces = {"force_x_N", "force_z_N", "moment_theta_Nm", "moment_psi_Nm"};
  constexpr std::array<const char*, kPoseSize> kOf = {"x_m", "z_m", "theta_rad", "psi_rad"};
  std::vector<Coefficient> out;
  for (const char* force : kForces) {
    for (const char* of : kOf)
      out.push_back({std::string(force) + "_per_" + of + (relaxes_ ? "" : "_per_s")});
  }
  return out;
}

Eigen::MatrixXd PlatformMatrix::columns(const EffectInput& input, int actuator,
                                        const std::vector<double>& shape) const {
  const double period_s = input.signals().period_s, keeps = relaxes_ ? std::exp(-period_s / shape[0]) : 0.0,
               gains = relaxes_ ? (1.0 - keeps) * shape[0] : 1.0;
  Eigen::MatrixXd out(input.samples(), kPoseSize * kPoseSize);
  Eigen::RowVector4d now = Eigen::RowVector4d::Zero();  // it stood before it was recorded
  for (int n = 0; n < input.samples(); ++n) {
    const std::size_t sample = static_cast<std::size_t>(n);
    now = keeps * now + gains * input.observation->motion.motion[sample].pose_velocity.transpose();
    for (int row = 0; row < kPoseSize; ++row)
      out.block<1, kPoseSize>(n, kPoseSize * row) = input.force_per_pose_force[sample](actuator, row) * now;
  }
  return out;
}

}  // namespace

void addPlatformMatrices(const std::vector<EffectInput>& inputs, CandidateList& maps) {
  if (!inputs.front().robot->mechanism) return;
  for (const bool relaxes : {false, true})
    maps.push_back(std::make_unique<PlatformMatrix>(relaxes));
}

std::unique_ptr<Candidate> platformMatrix(const std::string& depends_on) {
  for (const bool relaxes : {false, true}) {
    auto map = std::make_unique<PlatformMatrix>(relaxes);
    if (map->dependsOn(0) == depends_on) return map;
  }
  return nullptr;
}

}  // namespace knee_robot::tracing
