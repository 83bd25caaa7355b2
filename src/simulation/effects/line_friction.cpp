// {name: line_friction, friction_N: 15, proportional_below_m_per_s: 0.004, anchor_m: [0, 0, 1.8], point_m: [0.1, -0.1, 0]}
// A rope from a point of the base (or of the frame above) to one of the platform, over a pulley that rubs: a force against
// the rate of their distance, tanh(rate / proportional_below_m_per_s) of friction_N.
#include <cmath>

#include "common/link.h"

namespace knee_robot::simulation {
namespace {

class LineFriction : public EffectOf<LineFriction> {
 public:
  explicit LineFriction(StrictMap& entry)
      : link_(entry),
        friction_N_(entry.number("friction_N", 0.0, 1000.0)),
        proportional_below_m_per_s_(entry.number("proportional_below_m_per_s", 1e-3, 1.0)) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    loads.pose_force += link_.pull(at.pose, friction_N_ * std::tanh(link_.rate(at) / proportional_below_m_per_s_));
  }

 private:
  Link link_;
  double friction_N_, proportional_below_m_per_s_;
};

}  // namespace

std::unique_ptr<Effect> makeLineFriction(StrictMap& entry) {
  return std::make_unique<LineFriction>(entry);
}

}  // namespace knee_robot::simulation
