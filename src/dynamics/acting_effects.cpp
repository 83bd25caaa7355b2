#include "knee_robot/dynamics/acting_effects.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/dynamics/model.h"
#include "named_values.h"

namespace knee_robot::dynamics {
namespace {

constexpr double kSegment_s = 0.01;  ///< of a reference
constexpr double kTurnCounts = 2.0;  ///< as in tracing: a smaller way back is the encoder's flicker

std::string displayName(const ModelEffect& e) {
  return e.depends_on.empty() ? e.name : e.name + " (" + e.depends_on + ")";
}

std::vector<double> valuesOf(const std::vector<EffectParameter>& parameters) {
  std::vector<double> values;
  for (const EffectParameter& p : parameters)
    values.push_back(p.value);
  return values;
}

class Reader {
 public:
  Reader(const mechanism::Robot& robot, ActingEffects& to) : robot_(robot), to_(to) {}

  /// Of effects that were found: those that no law gives.
  void nameLeftOut(const ModelEffect& e) {
    if (e.transfers && !effectLaw(e.name, e.depends_on, valuesOf(e.shape))) leaveOut(e, whyNotInstantly(e.name));
  }

  void add(const ModelEffect& e) {
    std::vector<double> coefficients = valuesOf(e.coefficients);
    if (!e.transfers) return leaveOut(e, "it belongs to the recordings of its training");
    std::shared_ptr<const EffectLaw> law = effectLaw(e.name, e.depends_on, valuesOf(e.shape));
    if (!law) {
      const std::string reason = whyNotInstantly(e.name);
      if (reason.empty())
        throw InputError("effect " + displayName(e) + " is not known, or has other numbers; trace again");
      return leaveOut(e, reason);
    }
    coefficients = law->inOtherRecordings(std::move(coefficients));
    if (coefficients.size() != static_cast<std::size_t>(law->coefficients()) || e.actuators.empty() ||
        (law->shared() && !robot_.mechanism)) {
      throw InputError("effect " + displayName(e) + " has " + std::to_string(coefficients.size()) +
                       " coefficients where " + std::to_string(law->coefficients()) + " belong; trace again");
    }
    ActingEffect acting;
    acting.law = std::move(law);
    std::copy(coefficients.begin(), coefficients.end(), acting.coefficients.begin());
    if (acting.law->shared()) return put(acting);
    for (const int actuator : e.actuators) {
      acting.actuator = actuator - 1;
      put(acting);
    }
  }

 private:
  void put(const ActingEffect& acting) {
    if (acting.law->part() == EffectPart::Gain) {
      double& gain = to_.gain[acting.actuator];
      gain += acting.coefficients[0];
      if (gain > kMostForceGain)
        throw InputError("effect force_gain says that axis " + std::to_string(acting.actuator + 1) +
                         " gives less than " + shortNumber(100.0 * (1.0 - kMostForceGain), 2) +
                         " % of its command; such a model is not fed forward, see to the drive");
    } else if (acting.law->part() == EffectPart::Ahead) {
      to_.ahead_s[acting.actuator] += acting.coefficients[0];
    } else {
      if (to_.acting.size() == static_cast<std::size_t>(kMostActingEffects))
        throw InputError("the model has more than " + std::to_string(kMostActingEffects) + " effects");
      to_.acting.push_back(acting);
    }
  }
  void leaveOut(const ModelEffect& e, const std::string& reason) {
    const bool one = e.actuators.size() == 1;
    to_.left_out.push_back(
        {displayName(e), one ? "axis " + std::to_string(e.actuators.front()) : "the platform", reason});
  }

  const mechanism::Robot& robot_;
  ActingEffects& to_;
};

EffectsSee seenBy(const Model& model, const std::vector<double>& values, bool bench) {
  EffectsSee see;
  if (bench) {
    see.axis_load = axisValues(model, values);
    see.coulomb = see.axis_load.row(1).transpose();
    see.axis_rubbing.row(0) = see.axis_load.row(0);
    see.axis_load.topRows<2>().setZero();
    return see;
  }
  see.load = extendedValues(model, values);
  constexpr int kRubbing = extended::kRotor - extended::kPassiveFriction;
  see.rubbing.segment<kRubbing>(extended::kPassiveFriction) = see.load.segment<kRubbing>(extended::kPassiveFriction);
  see.coulomb = see.load.segment<mechanism::kLegs>(extended::kCoulomb);
  see.rubbing.segment<mechanism::kLegs>(extended::kCoulomb).setZero();
  see.load.segment<kRubbing>(extended::kPassiveFriction).setZero();
  return see;
}

}  // namespace

ActingEffects::ActingEffects(const Model& model, const mechanism::Robot& robot) {
  Reader reader(robot, *this);
  const ModelElsewhere* const numbers = numbersOfController(model);
  for (const ModelEffect& e : effectsOfController(model))
    reader.add(e);
  if (model.feedforward) {  // fitted without what a controller cannot give
    for (const ModelEffect& e : model.elsewhere ? model.elsewhere->effects : model.effects)
      reader.nameLeftOut(e);
  }
  if (model.elsewhere) {  // what training recordings have of their own is left out as well
    for (const ModelEffect& e : model.effects) {
      if (!e.transfers) reader.add(e);
    }
  }
  for (int i = 0; i < robot.axes(); ++i)
    turn_m[i] = kTurnCounts * robot.actuators[static_cast<std::size_t>(i)].metresPerCount();
  if (!any()) return;
  const std::vector<double>& values = numbers ? numbers->effects_see : model.effects_see;
  if (values.size() != model.parameters.size())
    throw InputError("lacks effects_see, without which its effects cannot be computed; trace again with this version");
  see = seenBy(model, values, !robot.mechanism);
}

/// A point is left where the way from it is more than this share of what counts as a way back.
constexpr double kLeft = 0.25;

void ReversalTracker::turn() noexcept {
  if (size_ == kMostTurns) {
    std::copy(turns_.begin() + 1, turns_.end(), turns_.begin());
    --size_;
  }
  turns_[size_++] = turned_last_ = extreme_;
  turned_ = true;
  since_turn_s_ = since_extreme_s_;
  direction_ = -direction_;
  extreme_ = at_;
  since_extreme_s_ = 0.0;
}

void ReversalTracker::closeLoops() noexcept {
  while (size_ >= 2 && direction_ * (at_ - turns_[size_ - 2]) > 0.0) {
    if (size_ == 2) turns_[0] = turns_[1];  // nothing older: this stroke is the longest so far
    size_ = size_ == 2 ? 1 : size_ - 2;
  }
}

SinceReversal ReversalTracker::step(double displacement_m, double period_s, double turn_m) noexcept {
  at_ += displacement_m;
  since_turn_s_ += period_s;
  since_extreme_s_ += period_s;
  if (direction_ == 0.0 && std::abs(at_ - turns_[0]) > turn_m) direction_ = at_ > turns_[0] ? 1.0 : -1.0;
  if (direction_ * (at_ - extreme_) > 0.0 || direction_ == 0.0) extreme_ = at_;
  if (std::abs(extreme_ - at_) <= kLeft * turn_m) since_extreme_s_ = 0.0;
  if (direction_ * (extreme_ - at_) > turn_m) turn();
  closeLoops();
  return {std::abs(at_ - turns_[size_ - 1]), since_turn_s_, std::abs(at_ - turned_last_), turned_};
}

void MotionMemory::follow(const mechanism::Vector4& now, double period_s) noexcept {
  if (moved && period_s > 0.0) jerk += std::min(1.0, period_s / kSegment_s) * ((now - acceleration) / period_s - jerk);
  acceleration = now;
  moved = true;
}

EffectForces effectForces(const ActingEffects& effects, int axes, const EffectsInstant& at,
                          MotionMemory& memory) noexcept {
  EffectForces forces;
  EffectInstant one;
  one.period_s = at.period_s;
  one.position_m = at.position_m;
  one.velocity_m_per_s = at.velocity_m_per_s;
  one.mechanism = at.mechanism;
  one.motion = at.motion;
  std::array<SinceReversal, mechanism::kLegs> since_reversal;
  for (int i = 0; i < axes; ++i) {
    const std::size_t axis = static_cast<std::size_t>(i);
    since_reversal[axis] = memory.turned[axis].step(at.displacement_m[i], at.period_s, effects.turn_m[i]);
  }
  mechanism::Vector4 carried_pose = mechanism::Vector4::Zero(), friction_pose = mechanism::Vector4::Zero();
  for (std::size_t k = 0; k < effects.acting.size(); ++k) {
    const ActingEffect& e = effects.acting[k];
    const bool carried = e.law->part() == EffectPart::Carried;
    const int count = e.law->coefficients();
    if (e.actuator < 0) {
      one.fade = at.fade.maxCoeff();  // the platform rests where all do
      PoseColumns columns;
      e.law->poseColumns(one, memory.effects[k], columns);
      for (int c = 0; c < count; ++c)
        (carried ? carried_pose : friction_pose) += e.coefficients[static_cast<std::size_t>(c)] * columns.col(c);
      continue;
    }
    one.actuator = e.actuator;
    one.share = at.share[e.actuator];
    one.displacement_m = at.displacement_m[e.actuator];
    one.since_reversal = since_reversal[static_cast<std::size_t>(e.actuator)];
    one.load_N = at.load_N[e.actuator];
    one.fade = at.fade[e.actuator];
    EffectColumns columns;
    e.law->columns(one, memory.effects[k], columns);
    double force = 0.0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
      force += e.coefficients[c] * columns[c];
    (carried ? forces.carried : forces.friction)[e.actuator] += force;
  }
  if (at.pose_per_length != nullptr) {
    forces.carried.noalias() += at.pose_per_length->transpose() * carried_pose;
    forces.friction.noalias() += at.pose_per_length->transpose() * friction_pose;
  }
  return forces;
}

void rest(const ActingEffects& effects, double duration_s, MotionMemory& memory) noexcept {
  memory.friction.fill(FrictionState{});
  memory.turned.fill(ReversalTracker{});
  memory.jerk.setZero();
  memory.moved = false;
  for (std::size_t k = 0; k < effects.acting.size(); ++k)
    effects.acting[k].law->rest(duration_s, memory.effects[k]);
}

}  // namespace knee_robot::dynamics
