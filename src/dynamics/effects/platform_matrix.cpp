#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

constexpr int kPoseSize = 4;

/// Forces and moments on the platform as a matrix, row by row, times its velocity; or times the way that it went of
/// late, which is forgotten with a time.
class PlatformMatrix : public EffectLaw {
 public:
  /// 0 s: over the velocity.
  explicit PlatformMatrix(double relaxation_s) : relaxation_s_(relaxation_s) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  int coefficients() const noexcept override { return kPoseSize * kPoseSize; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState& state, PoseColumns& out) const noexcept override {
    const bool relaxes = relaxation_s_ > 0.0;
    const double keeps = relaxes ? std::exp(-at.period_s / relaxation_s_) : 0.0,
                 gains = relaxes ? (1.0 - keeps) * relaxation_s_ : 1.0;
    state.of_pose = keeps * state.of_pose + gains * at.motion->pose_velocity;
    out.setZero();
    for (int row = 0; row < kPoseSize; ++row)
      out.block<1, kPoseSize>(row, kPoseSize * row) = state.of_pose.transpose();
  }
  void rest(double duration_s, EffectState& state) const noexcept override {
    state.of_pose *= relaxation_s_ > 0.0 ? std::exp(-duration_s / relaxation_s_) : 0.0;
  }

 private:
  const double relaxation_s_;
};

}  // namespace

Law platformMatrixLaw(const std::string& depends_on, const Shape& shape) {
  if (depends_on == "platform_velocity" && shape.empty()) return std::make_unique<PlatformMatrix>(0.0);
  const bool relaxes = shape.size() == 1 && shape[0] > 0.0;
  if (depends_on == "platform_way_of_late" && relaxes) return std::make_unique<PlatformMatrix>(shape[0]);
  return nullptr;
}

}  // namespace knee_robot::dynamics
