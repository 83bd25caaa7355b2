// {name: viscoelastic_link, stiffness_N_per_m: 600, relaxation_s: 1, anchor_m: [0.2, 0.3, 0], point_m: [0.2, 0.2, 0]}
// A spring in series with a damper between a point of the base and one of the platform (tissue, a strap, a rubber band):
// d stretched/dt = rate - stretched / relaxation. It is relaxed when the simulation begins.
#include <cmath>

#include "common/link.h"

namespace knee_robot::simulation {
namespace {

class ViscoelasticLink : public EffectOf<ViscoelasticLink> {
 public:
  explicit ViscoelasticLink(StrictMap& entry)
      : link_(entry),
        stiffness_(entry.number("stiffness_N_per_m", 0.0, 1e5)),
        relaxation_s_(entry.number("relaxation_s", 0.01, 1e4)) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    loads.pose_force += link_.pull(at.pose, stiffness_ * stretched_m_);
  }
  void follow(const EffectStep& now) noexcept override {
    const double keeps = std::exp(-now.dt_s / relaxation_s_);
    stretched_m_ = keeps * stretched_m_ + (1.0 - keeps) * relaxation_s_ * link_.rate(now);
  }

 private:
  Link link_;
  double stiffness_, relaxation_s_;
  double stretched_m_ = 0.0;
};

}  // namespace

std::unique_ptr<Effect> makeViscoelasticLink(StrictMap& entry) {
  return std::make_unique<ViscoelasticLink>(entry);
}

}  // namespace knee_robot::simulation
