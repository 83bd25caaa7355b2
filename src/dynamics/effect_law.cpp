#include "knee_robot/dynamics/effect_law.h"

#include <algorithm>

#include "effects/laws.h"

namespace knee_robot::dynamics {
namespace {

struct Entry {
  const char* name;
  std::size_t shape;  ///< how many numbers it takes
  Law (*make)(const Shape&);
};

constexpr Entry kLaws[] = {
    {"asymmetric_coulomb", 0, asymmetricCoulombLaw},
    {"asymmetric_viscous", 0, asymmetricViscousLaw},
    {"stribeck", 1, stribeckLaw},
    {"presliding", 1, preslidingLaw},
    {"load_dependent_friction", 0, loadDependentFrictionLaw},
    {"load_dependent_viscous", 0, loadDependentViscousLaw},
    {"power_flow_friction", 0, powerFlowFrictionLaw},
    {"position_dependent_friction", 4, positionDependentFrictionLaw},
    {"screw_ripple", 2, screwRippleLaw},
    {"quadratic_drag", 0, quadraticDragLaw},
    {"thermal_drift", 1, thermalDriftLaw},
    {"force_gain", 0, forceGainLaw},
    {"force_offset", 0, forceOffsetLaw},
    {"delay", 0, delayLaw},
    {"drive_lag", 0, delayLaw},
    {"spring", 4, springLaw},
    {"dashpot", 5, dashpotLaw},
};

}  // namespace

void EffectLaw::columns(const EffectInstant&, EffectState&, EffectColumns&) const noexcept {}
void EffectLaw::poseColumns(const mechanism::Motion&, PoseColumns&) const noexcept {}
void EffectLaw::rest(double, EffectState& state) const noexcept {
  state = EffectState{};
}

std::unique_ptr<const EffectLaw> effectLaw(const std::string& name, const std::string& depends_on,
                                           const std::vector<double>& shape) {
  if (name == "unnamed") return mapLaw(depends_on, shape);
  const auto* const found =
      std::find_if(std::begin(kLaws), std::end(kLaws), [&](const Entry& entry) { return name == entry.name; });
  if (found == std::end(kLaws) || shape.size() != found->shape) return nullptr;
  return found->make(shape);
}

std::string whyNotInstantly(const std::string& name) {
  if (name == "external_force") return "it belongs to one recording";
  if (name == "backlash" || name == "flexible_coupling")
    return "it moves the load apart from the motor, which only the whole recording shows";
  if (name == "unnamed") return "its signal means nothing while the robot runs on";
  return "";
}

}  // namespace knee_robot::dynamics
