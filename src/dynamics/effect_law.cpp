#include "knee_robot/dynamics/effect_law.h"

#include <algorithm>
#include <cmath>

#include "effects/laws.h"

namespace knee_robot::dynamics {
namespace {

struct Entry {
  const char* name;
  std::size_t shape;  ///< how many numbers it takes
  Law (*make)(const Shape&);
  bool own_rest_law =
      false;              ///< takes one more number: the speed below which it is smooth by a law of its own; 0: none
  std::size_t since = 0;  ///< further numbers (before that one), which older files do not have
};

/// Friction that builds up near rest by a smooth law of its own, tanh(v / speed), instead of the actuator's.
class SmoothNearRest : public EffectLaw {
 public:
  SmoothNearRest(Law law, double speed_m_per_s) : law_(std::move(law)), speed_m_per_s_(speed_m_per_s) {}
  EffectPart part() const noexcept override { return law_->part(); }
  int coefficients() const noexcept override { return law_->coefficients(); }
  std::vector<double> inOtherRecordings(std::vector<double> coefficients) const override {
    return law_->inOtherRecordings(std::move(coefficients));
  }
  void columns(const EffectInstant& at, EffectState& state, EffectColumns& out) const noexcept override {
    EffectInstant own = at;
    own.share = std::tanh(at.velocity_m_per_s[at.actuator] / speed_m_per_s_);
    law_->columns(own, state, out);
  }
  void rest(double duration_s, EffectState& state) const noexcept override { law_->rest(duration_s, state); }

 private:
  const Law law_;
  const double speed_m_per_s_;
};

constexpr Entry kLaws[] = {
    {"asymmetric_coulomb", 0, asymmetricCoulombLaw, true},
    {"asymmetric_viscous", 0, asymmetricViscousLaw},
    {"stribeck", 1, stribeckLaw, true, 1},
    {"presliding", 1, preslidingLaw},
    {"load_dependent_friction", 0, loadDependentFrictionLaw, true},
    {"load_dependent_viscous", 0, loadDependentViscousLaw},
    {"power_flow_friction", 0, powerFlowFrictionLaw},
    {"position_dependent_friction", 4, positionDependentFrictionLaw, true},
    {"screw_ripple", 2, screwRippleLaw},
    {"quadratic_drag", 0, quadraticDragLaw},
    {"screw_whirl", 3, screwWhirlLaw},
    {"thermal_drift", 1, thermalDriftLaw, true, 3},
    {"frictional_ageing", 2, frictionalAgeingLaw, true},
    {"reversal_friction", 3, reversalFrictionLaw, true},
    {"force_gain", 0, forceGainLaw},
    {"force_offset", 0, forceOffsetLaw},
    {"actuator_spring", 1, actuatorSpringLaw},
    {"delay", 0, delayLaw},
    {"drive_lag", 0, delayLaw},
    {"spring", 4, springLaw},
    {"one_sided_spring", 9, oneSidedSpringLaw},
    {"link_between_legs", 6, linkBetweenLegsLaw},
    {"dashpot", 5, dashpotLaw},
    {"asymmetric_dashpot", 5, asymmetricDashpotLaw},
    {"viscoelastic_link", 5, viscoelasticLinkLaw},
    {"elastoplastic_link", 6, elastoplasticLinkLaw},
    {"line_friction", 6, lineFrictionLaw},
    {"platform_joint_friction", 1, platformJointFrictionLaw, false, 1},
    {"base_joint_friction", 1, baseJointFrictionLaw, false, 1},
    {"load_ripple", 1, loadRippleLaw},
    {"viscoelastic_element", 2, viscoelasticElementLaw},
};

}  // namespace

std::vector<double> EffectLaw::inOtherRecordings(std::vector<double> coefficients) const {
  return coefficients;
}
void EffectLaw::columns(const EffectInstant&, EffectState&, EffectColumns&) const noexcept {}
void EffectLaw::poseColumns(const EffectInstant&, EffectState&, PoseColumns&) const noexcept {}
void EffectLaw::rest(double, EffectState& state) const noexcept {
  state = EffectState{};
}

std::unique_ptr<const EffectLaw> effectLaw(const std::string& name, const std::string& depends_on,
                                           const std::vector<double>& shape) {
  if (name == "unnamed") return mapLaw(depends_on, shape);
  const auto* const found =
      std::find_if(std::begin(kLaws), std::end(kLaws), [&](const Entry& entry) { return name == entry.name; });
  if (found == std::end(kLaws)) return nullptr;
  const bool with_rest_law =
      found->own_rest_law && shape.size() > found->shape && shape.size() <= found->shape + found->since + 1;
  if (!with_rest_law) {
    const bool fits =
        shape.size() == found->shape || (!found->own_rest_law && shape.size() == found->shape + found->since);
    return fits ? found->make(shape) : nullptr;
  }
  Law law = found->make({shape.begin(), shape.end() - 1});
  if (!law || shape.back() == 0.0) return law;
  return std::make_unique<SmoothNearRest>(std::move(law), shape.back());
}

bool actsOnWithoutLaw(const std::string& name) {
  for (const char* other :
       {"external_force", "payload_change", "sensor_lag", "stretch_reflex", "joint_stretch_reflex", "passive_joint"}) {
    if (name == other) return false;
  }
  return true;
}

std::string whyNotInstantly(const std::string& name) {
  if (name == "external_force") return "it belongs to one recording";
  if (name == "backlash" || name == "flexible_coupling")
    return "it moves the load apart from the motor, which only the whole recording shows";
  if (name == "wobbling_mass" || name == "hanging_mass") return "how far it swings is not known to the controller";
  if (name == "sliding_mass") return "where it lies is not known to the controller";
  if (name == "payload_change") return "what the next recording carries is not known; declare it (payload_kg)";
  if (name == "sensor_lag") return "it lies in the recording of the force, not in the force";
  if (name == "supply_sag") return "what the drives take together is known only after each has been given its command";
  if (name == "drive_dead_zone")
    return "a command that jumps wherever the force changes its sign would make it chatter";
  if (name == "idle_current_reduction") return "the drive decides when it cuts its current; switch it off there";
  if (name == "motor_saturation") return "a motor at its limit is not to be asked for more; take a larger one";
  if (name == "gain_drift") return "how warm the motors are is not known to the controller";
  if (name == "stretch_reflex" || name == "joint_stretch_reflex")
    return "it is the patient's and comes late; a controller that pushes on would answer it";
  if (name == "passive_joint")
    return "it is the patient's, and another one's is another; what pushes on where somebody's range ends may hurt";
  if (name == "nonlinear_spring") return "its curve is known between the lengths of training only";
  if (name == "unnamed")
    return "its signal is no state of the motion (time in a recording, or since a place was passed, or what a drive "
           "has to give), or it is a surface over two signals";
  return "";
}

}  // namespace knee_robot::dynamics
