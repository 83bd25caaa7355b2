// {name: payload, mass_kg: 5, center_m: [0, 0, 0.1], radius_of_gyration_m: 0.1} A mass fixed to the platform (centre in
// the platform frame; radius of gyration about any axis through it, optional). The simulation file's own key `payload`
// does the same.
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class HiddenPayload : public EffectOf<HiddenPayload> {
 public:
  explicit HiddenPayload(StrictMap& entry)
      : mass_kg_(entry.number("mass_kg", 0.0, 500.0)),
        center_m_(readVector3(entry, "center_m", -2.0, 2.0)),
        gyration_m_(entry.numberOr("radius_of_gyration_m", 0.0, 0.0, 2.0)) {}
  void changePlant(PlantModel& model) override {
    dynamics::BodyConstants& platform = model.rigid.platform;
    platform.mass += mass_kg_;
    platform.first_moment += mass_kg_ * center_m_;
    platform.inertia +=
        mass_kg_ * ((center_m_.squaredNorm() + gyration_m_ * gyration_m_) * mechanism::Matrix3::Identity() -
                    center_m_ * center_m_.transpose());
  }

 private:
  double mass_kg_;
  mechanism::Vector3 center_m_;
  double gyration_m_;
};

}  // namespace

std::unique_ptr<Effect> makePayload(StrictMap& entry) {
  return std::make_unique<HiddenPayload>(entry);
}

}  // namespace knee_robot::simulation
