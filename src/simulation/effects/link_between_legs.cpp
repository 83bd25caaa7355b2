// {name: link_between_legs, first_leg: 1, second_leg: 2, between: cylinders, acts_from_m: 0.4, side: longer,
//  stiffness_N_per_m: 300, stiffening_N_per_m2: 2000, damping_N_s_per_m: 20, friction_N: 2, rubs_over_m: 0.005}
// A hose or a cable bundle from one leg to another, at `tied_at_m` from their joints: goes taut beyond a length (side:
// longer), or pushes below it (side: shorter); damps as long as it is taut, and rubs.
#include <algorithm>
#include <cmath>
#include <optional>

#include "knee_robot/mechanism/leg_distance.h"
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

mechanism::BetweenLegs readBetween(StrictMap& entry) {
  const std::string between = entry.choice("between", {"lengths", "cylinders", "rods"});
  if (between == "lengths") return mechanism::BetweenLegs::Lengths;
  return between == "rods" ? mechanism::BetweenLegs::Rods : mechanism::BetweenLegs::Cylinders;
}

mechanism::LegPair readPair(StrictMap& entry) {
  mechanism::LegPair pair;
  pair.first = static_cast<int>(entry.integer("first_leg", 1, mechanism::kLegs)) - 1;
  pair.second = static_cast<int>(entry.integer("second_leg", 1, mechanism::kLegs)) - 1;
  if (pair.first == pair.second) entry.refuse("second_leg", "is the first one, too; give another leg");
  pair.between = readBetween(entry);
  pair.at_m = entry.numberOr("tied_at_m", 0.2, 0.0, 1.0);
  return pair;
}

class LinkBetweenLegs : public EffectOf<LinkBetweenLegs> {
 public:
  explicit LinkBetweenLegs(StrictMap& entry)
      : pair_(readPair(entry)),
        acts_from_m_(entry.number("acts_from_m", -3.0, 10.0)),
        side_(entry.choice("side", {"longer", "shorter"}) == "longer" ? 1.0 : -1.0),
        stiffness_(entry.numberOr("stiffness_N_per_m", 0.0, 0.0, 1e6)),
        stiffening_(entry.numberOr("stiffening_N_per_m2", 0.0, 0.0, 1e7)),
        damping_(entry.numberOr("damping_N_s_per_m", 0.0, 0.0, 1e5)),
        friction_N_(entry.numberOr("friction_N", 0.0, 0.0, 1000.0)),
        rubs_over_m_(entry.numberOr("rubs_over_m", 0.005, 1e-4, 0.5)) {}
  void changePlant(PlantModel& model) override { mechanism_ = model.rigid.mechanism; }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    const mechanism::LegDistance now = mechanism::legDistance(*mechanism_, at.pose, pair_);
    const double taut_m = std::max(0.0, side_ * (now.length_m - acts_from_m_));
    const double rate = now.by_pose.dot(at.pose_velocity);
    const double resists_N = side_ * (stiffness_ + stiffening_ * taut_m) * taut_m +
                             (taut_m > 0.0 ? damping_ * rate : 0.0) + friction_N_ * share_;
    loads.pose_force -= resists_N * now.by_pose;
  }
  void follow(const EffectStep& now) noexcept override {
    const double way_m = mechanism::legDistance(*mechanism_, now.pose, pair_).by_pose.dot(now.pose_velocity) * now.dt_s;
    const double to = way_m > 0.0 ? 1.0 : -1.0;
    share_ = to + (share_ - to) * std::exp(-std::abs(way_m) / rubs_over_m_);
  }

 private:
  mechanism::LegPair pair_;
  double acts_from_m_, side_, stiffness_, stiffening_, damping_, friction_N_, rubs_over_m_;
  double share_ = 0.0;  ///< of friction_N: comes up over a way after each reversal
  std::optional<mechanism::Mechanism> mechanism_;
};

}  // namespace

std::unique_ptr<Effect> makeLinkBetweenLegs(StrictMap& entry) {
  return std::make_unique<LinkBetweenLegs>(entry);
}

}  // namespace knee_robot::simulation
