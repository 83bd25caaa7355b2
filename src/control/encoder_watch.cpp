#include "knee_robot/control/encoder_watch.h"

#include <cmath>

namespace knee_robot::control {
namespace {

/// Of the force that an encoder was asked with before: a hand guides through most of the friction.
constexpr double kGuidedShare = 0.5;
/// Ten times the following error of a good loop: a healthy axis so far behind its reference moves when it is asked.
constexpr double kLeftBehind_m = 0.001;
/// After the brakes opened: the platform sags a little, and what is asked meanwhile teaches nothing.
constexpr double kSags_s = 0.5;

}  // namespace

/// At rest the axes take turns; a suspicion is asked of all at once.
EncoderWatch::Output EncoderWatch::step(const Input& in, const Disturbance& disturbed,
                                        const Settings& settings) noexcept {
  out_ = Output{};
  if (!in.carries || settings.probe_s <= 0.0) {
    carried_s_ = 0.0;
    suspicion_ = disturbed.suspicion;
    questions_ = disturbed.questions;
    challenge_.reset();
    probe_.reset();
    return out_;
  }
  if (carried_s_ == 0.0) released_.begin(in.counts);
  carried_s_ += in.dt;
  released_.take(in.counts);
  if (carried_s_ < settings.open_s) return out_;  // the holding brakes are still opening
  const bool just_opened = carried_s_ - in.dt < settings.open_s;
  const bool settled = carried_s_ >= kSags_s;
  if (!settled && !just_opened && !challenge_.isActive()) return out_;
  out_.can_be_asked = settings.monitored;
  const double first = kSags_s + settings.probe_s * static_cast<double>(settings.index) / hardware::kAxes;
  const EncoderProbe::Settings probing{first, settings.probe_s, settings.probe_share * settings.force_limit_N,
                                       settings.observed};
  if (challenge(in, disturbed, settings, probing, just_opened)) {
    out_.force_N = challenge_.force_N();
    return out_;
  }
  // A hand is guided by HandGuide's questions: pulses that learn would free the friction that holds what nobody declared.
  if (!settled || (in.guiding && settings.observed)) return out_;
  if (!in.test_pulses) {
    if (!settings.observed) probe_.reset();
    return out_;
  }
  if (!probe_.step(in.at_rest, in.dt, in.counts, probing)) raiseDeadOrBlocked(in, disturbed, settings);
  out_.force_N = probe_.force_N();
  return out_;
}

/// True while it asks, or brings its pulse to an end. An axis whose encoder has not counted while its brake opened is
/// asked at once: blind, it lets the platform sink by a load that nobody declared, and its loop sees nothing of it.
bool EncoderWatch::challenge(const Input& in, const Disturbance& disturbed, const Settings& settings,
                             const EncoderProbe::Settings& probing, bool just_opened) noexcept {
  const bool unseen = just_opened && !released_.counts() && in.test_pulses;
  const bool is_disturbed = disturbed.suspicion != suspicion_;
  const bool suspected = carried_s_ >= kSags_s && standsUnderForce(in, settings);
  const bool in_turn =
      disturbed.questions != questions_ && disturbed.asked == static_cast<int>(settings.index) && in.test_pulses;
  suspicion_ = disturbed.suspicion;
  questions_ = disturbed.questions;
  if (in.silent) {  // old counts are no answer; that they are old has a fault of its own
    challenge_.reset();
    standing_.begin(in.counts);
    return false;
  }
  const bool wanted =
      unseen || (is_disturbed && !standing_.counts()) || suspected || in_turn || in.monitor_asks || in.doubted;
  if (wanted && !challenge_.isActive()) {
    opening_ = just_opened;
    // A hand has no reference: to and fro in turn, or questions would carry the platform away.
    if (in.guides) guided_away_ = -guided_away_;
    const double away = in.guides ? guided_away_ : (in.reference_m - in.position_m) / settings.metres_per_count;
    const double enough_N = (in.guides ? kGuidedShare : 1.0) * probe_.enoughForce_N();
    challenge_.begin(in.counts, {enough_N, probe_.certainForce_N(probing), away, standing_.dithers(),
                                 !unseen && !is_disturbed && in.at_rest, !in.at_rest});
  }
  const double lag_m = std::abs(in.reference_m - in.position_m);
  switch (challenge_.step(in.dt, in.counts, in.at_rest || in.guides || lag_m < kLeftBehind_m)) {
    case EncoderChallenge::Verdict::Alive:
      if (!opening_) probe_.acceptAnswer(in.counts);  // what is enough it still has to learn
      standing_.endures(asked_at_N_);
      out_.answered = true;
      break;
    case EncoderChallenge::Verdict::Dead:
      raiseDeadOrBlocked(in, disturbed, settings);
      break;
    case EncoderChallenge::Verdict::None:
      break;
  }
  return challenge_.isActive();
}

/// What no count to all this means.
void EncoderWatch::raiseDeadOrBlocked(const Input& in, const Disturbance& disturbed,
                                      const Settings& settings) noexcept {
  // At rest the others stick and may feel nothing of an axis that moves.
  const bool blocked = disturbed.felt[settings.index] == Felt::No && !in.at_rest;
  out_.fault = blocked ? Fault::AxisBlocked : Fault::EncoderFrozen;
}

/// A healthy axis that hunts at rest is asked less and less often.
bool EncoderWatch::standsUnderForce(const Input& in, const Settings& settings) noexcept {
  constexpr double kWhileRecording = 2.0;
  constexpr double kOverdueShare = 0.5;                    // of the force: a soft loop lags without being blind
  constexpr double kBeyondUsual = 1.3, kUsualMost = 0.25;  // of the force limit: friction may not hide a blind axis
  constexpr double kPresses = 0.4;                         // of the strongest pulse, which has to pull it off a stop
  constexpr double kAgain_s = 0.5, kSeldom_s = 4.0, kAgainMoving_s = 0.15, kAgainOverdue_s = 0.03, kTimes = 4.0;
  const bool rests = in.at_rest;
  standing_.step(in.dt, in.counts, in.reference_m, in.loop_N, challenge_.isActive());
  if (rests != stood_at_rest_) {
    standing_.begin(in.counts);
    again_s_ = kAgain_s;
  }
  stood_at_rest_ = rests;
  asked_s_ += in.dt;
  const double usual_N = std::min(kBeyondUsual * standing_.usual_N(), kUsualMost * settings.force_limit_N);
  // An axis that turns for the first times sticks, too. Recordings for a model are to have few questions: later then,
  // not never.
  const double patience = in.test_pulses ? 1.0 : kWhileRecording;
  const double limit_N = patience * (rests ? settings.standing_force_N : settings.turning_force_N);
  const double turning_N = std::max(limit_N, usual_N);
  // A blind one has been asked before it presses like that.
  if (in.searches && std::abs(in.loop_N) > kPresses * settings.probe_share * settings.force_limit_N) return false;
  const bool overdue = !rests && standing_.changed_N() >= kOverdueShare * limit_N &&
                       standing_.isOverdue(patience * settings.metres_per_count);
  const double again_moving_s = overdue ? kAgainOverdue_s : kAgainMoving_s;
  const double again_s = !rests ? again_moving_s : standing_.changed_N() > kTimes * limit_N ? kAgain_s : again_s_;
  if (!settings.observed || asked_s_ < again_s || (!overdue && standing_.changed_N() < (rests ? limit_N : turning_N)))
    return false;
  asked_at_N_ = rests ? 0.0 : standing_.changed_N();
  standing_.begin(in.counts);
  asked_s_ = 0.0;
  again_s_ = std::min(kSeldom_s, 2.0 * again_s_);
  return true;
}

}  // namespace knee_robot::control
