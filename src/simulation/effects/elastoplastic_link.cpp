// {name: elastoplastic_link, yield_N: 30, yield_m: 0.004, anchor_m: [0.2, 0.3, 0], point_m: [0.2, 0.2, 0]}
// A cable, an energy chain or a limb between a point of the base and one of the platform: dry friction along the line,
// which builds up over a way after each reversal (Dahl): d share = (sign(way) - share) |way| / yield_m.
#include <cmath>

#include "common/link.h"

namespace knee_robot::simulation {
namespace {

class ElastoplasticLink : public EffectOf<ElastoplasticLink> {
 public:
  explicit ElastoplasticLink(StrictMap& entry)
      : link_(entry), yield_N_(entry.number("yield_N", 0.0, 1e4)), yield_m_(entry.number("yield_m", 1e-4, 0.5)) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    loads.pose_force += link_.pull(at.pose, yield_N_ * share_);
  }
  void follow(const EffectStep& now) noexcept override {
    const double way_m = link_.rate(now) * now.dt_s, to = way_m > 0.0 ? 1.0 : -1.0;
    share_ = to + (share_ - to) * std::exp(-std::abs(way_m) / yield_m_);
  }

 private:
  Link link_;
  double yield_N_, yield_m_;
  double share_ = 0.0;  ///< of yield_N
};

}  // namespace

std::unique_ptr<Effect> makeElastoplasticLink(StrictMap& entry) {
  return std::make_unique<ElastoplasticLink>(entry);
}

}  // namespace knee_robot::simulation
