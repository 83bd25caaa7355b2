#include <algorithm>
#include <array>

#include "knots.h"
#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A generalized force on the platform along one coordinate of the pose: a piecewise linear function of that coordinate
/// or of its rate, or such a function times the rate.
class PlatformMap : public EffectLaw {
 public:
  PlatformMap(int coordinate, bool over_rate, bool times_rate, const Shape& knots)
      : coordinate_(coordinate), over_rate_(over_rate), times_rate_(times_rate), knots_(knots) {}
  EffectPart part() const noexcept override {
    return over_rate_ || times_rate_ ? EffectPart::Friction : EffectPart::Carried;
  }
  int coefficients() const noexcept override { return knots_.count; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState&, PoseColumns& out) const noexcept override {
    const double rate = at.motion->pose_velocity[coordinate_];
    EffectColumns hats;
    knots_.hats(over_rate_ ? rate : at.motion->pose[coordinate_], times_rate_ ? rate : 1.0, hats);
    out.setZero();
    for (int k = 0; k < knots_.count; ++k)
      out(coordinate_, k) = hats[static_cast<std::size_t>(k)];
  }

 private:
  const int coordinate_;
  const bool over_rate_, times_rate_;
  const Knots knots_;
};

constexpr std::array<const char*, 4> kPose = {"force_over_pose_x_m", "force_over_pose_z_m",
                                              "moment_over_pose_theta_rad", "moment_over_pose_psi_rad"};
constexpr std::array<const char*, 4> kRates = {"force_over_rate_x_m_per_s", "force_over_rate_z_m_per_s",
                                               "moment_over_rate_theta_rad_per_s", "moment_over_rate_psi_rad_per_s"};

}  // namespace

Law platformMapLaw(const std::string& depends_on, const Shape& knots) {
  for (std::size_t c = 0; c < kPose.size(); ++c) {
    const int coordinate = static_cast<int>(c);
    const std::string over_pose = std::string("platform_") + kPose[c];
    if (depends_on == over_pose) return std::make_unique<PlatformMap>(coordinate, false, false, knots);
    if (depends_on == over_pose + "_times_rate") return std::make_unique<PlatformMap>(coordinate, false, true, knots);
    if (depends_on == std::string("platform_") + kRates[c])
      return std::make_unique<PlatformMap>(coordinate, true, false, knots);
  }
  return nullptr;
}

}  // namespace knee_robot::dynamics
