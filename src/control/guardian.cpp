#include "knee_robot/control/guardian.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {

constexpr double kLargest_V = 10.0;  // of any set value; more was written by nobody who is meant to

}  // namespace

void GuardianWatch::listen(const GuardianView& view) noexcept {
  const bool moved = !any_ || view.heartbeat != heartbeat_;
  heard_ = heard_ || (any_ && moved);
  const rt::Nanoseconds elapsed = any_ ? view.now - last_step_ : 0;
  any_ = true;
  last_step_ = view.now;
  heartbeat_ = view.heartbeat;
  if (moved) last_heartbeat_ = view.now;
  silence_ = moved || !view.armed ? 0 : silence_ + std::min(elapsed, 2 * period_);
}

GuardianAction GuardianWatch::step(const GuardianView& view) noexcept {
  listen(view);
  if (view.reset_asked && !view.armed && !view.hands_over) {
    tripped_ = false;
    cause_ = GuardianCause::None;
    return GuardianAction::Release;
  }
  const bool locked_out = view.fenced && !tripped_;
  if (locked_out && view.armed) cause_ = GuardianCause::LockedOut;
  tripped_ = tripped_ || view.fenced;
  if (locked_out && view.armed) return GuardianAction::Trip;
  if (tripped_) return GuardianAction::KeepDown;
  if (!view.armed) return GuardianAction::Watch;
  if (view.process_gone) cause_ = GuardianCause::ProcessGone;
  if (cause_ == GuardianCause::None && silence_ >= silence_limit_) cause_ = GuardianCause::Silent;
  tripped_ = cause_ != GuardianCause::None;
  return tripped_ ? GuardianAction::Trip : GuardianAction::Watch;
}

Guardian::Guardian(hardware::GuardianLink& link, hardware::EmergencyOutputs& outputs, rt::Nanoseconds silence_limit,
                   rt::Nanoseconds period, rt::Nanoseconds (*clock)() noexcept, GuardianCarry carry)
    : rt::TaskContext("Guardian"),
      link_(link),
      outputs_(outputs),
      clock_(clock),
      watch_(silence_limit, period, link.tripped.load() != 0),
      carry_(carry) {}

bool Guardian::startHook() {
  pid_ = ::getpid();
  link_.guardian_pid.store(pid_);
  first_cycle_ = true;
  return true;
}

void Guardian::updateHook(const rt::Cycle& /*cycle*/) {
  if (isReplaced()) return;
  GuardianView view;
  view.now = clock_();
  view.heartbeat = link_.heartbeat.load(std::memory_order_acquire);
  const std::int32_t controller = link_.controller_pid.load();
  view.process_gone = process_.isGone(controller);
  if (first_cycle_) arrive(controller == 0 || view.process_gone);
  first_cycle_ = false;
  const std::uint32_t request = link_.reset_request.load();
  view.fenced = link_.tripped.load() != 0;
  view.reset_asked = request != link_.reset_done.load();
  view.hands_over = hand_over_.isWatching();
  view.armed = link_.armed.load() != 0;  // after the request: whoever asks has disarmed before
  switch (watch_.step(view)) {
    case GuardianAction::Watch:
      break;
    case GuardianAction::Trip:
      trip();
      break;
    case GuardianAction::KeepDown:
      keepDown(view.now);
      break;
    case GuardianAction::Release:
      if (hand_over_.isRunning()) outputs_.down();
      hand_over_ = GuardianHandOver();
      setActs(false);
      link_.tripped.store(0);
      link_.reset_done.store(request);
      report_.releases.fetch_add(1);
      break;
  }
  link_.guardian_cycles.fetch_add(1, std::memory_order_release);
}

void Guardian::arrive(bool nobody) noexcept {
  const bool goes_on = goesOn();
  report_.went_on.store(goes_on);
  setActs(goes_on);
  // A controller that has just died with its guardian: the trip that follows hands its load over.
  const bool left = link_.armed.load() != 0 && link_.tripped.load() == 0 && isLately(link_.carried_at_ns);
  if (goes_on || left || !nobody) return;
  // Nobody is in charge, and the link does not say for certain what a dead controller has left switched on.
  report_.written.store(outputs_.down() == hardware::IoStatus::Ok);
  report_.found_nobody.store(true);
}

/// A guardian has died while it carried, and the drives are still on with what it gave: brakes that were late may be so
/// still. Where it is longer ago, they hold; where none could be ordered, none does.
bool Guardian::goesOn() noexcept {
  if (link_.tripped.load() == 0 || link_.acts.load() == 0) return false;
  return (isLately(link_.acted_at_ns) || isStranded()) && carryLoad();
}

/// Within what a hand-over may take: nobody can have switched the drives off since without saying so in the link.
bool Guardian::isLately(const std::atomic<std::int64_t>& at_ns) const noexcept {
  const rt::Nanoseconds age = clock_() - at_ns.load();
  return age >= 0 && age <= GuardianHandOver::kLongest;
}

/// The holding brakes engage, as far as they can be ordered to; the drives give what carried the robot at rest.
bool Guardian::carryLoad() noexcept {
  if (carry_.time == 0) return false;
  for (std::size_t i = 0; i < load_V_.size(); ++i) {
    load_V_[i] = link_.load_V[i].load(std::memory_order_relaxed);
    if (!(std::abs(load_V_[i]) <= kLargest_V)) return false;
    slip_.slip_counts[i] = carry_.watches ? link_.slip_counts[i].load(std::memory_order_relaxed) : 0;
    slip_.counts_per_mm[i] = link_.counts_per_mm[i].load(std::memory_order_relaxed);
  }
  hand_over_.begin(clock_(), carry_.time, slip_);
  if (writeCarry()) return true;
  hand_over_ = GuardianHandOver();
  return false;
}

bool Guardian::writeCarry() noexcept {
  link_.acted_at_ns.store(clock_());
  beat_ = !beat_;
  const auto bits = static_cast<std::uint8_t>(carry_.outputs | (beat_ ? carry_.heartbeat : 0u));
  std::array<double, hardware::kChannels> volts = load_V_;
  for (double& one : volts)
    one *= hand_over_.share();
  orders_ = outputs_.carry(bits, volts) == hardware::IoStatus::Ok;
  return orders_ || isStranded();
}

/// The card with the digital outputs is gone: no brake can be ordered to engage, and 0 V would let the platform fall.
bool Guardian::isStranded() noexcept {
  GuardianHandOver::Counts counts{};
  const hardware::IoStatus status = outputs_.readCounts(counts);
  return status != hardware::IoStatus::Ok && status != hardware::IoStatus::NotReady;
}

/// A write already in progress passes the fence; so write again every cycle.
void Guardian::keepDown(rt::Nanoseconds now) noexcept {
  const bool carried = hand_over_.isRunning();
  if (carried) handOver(now);
  if (hand_over_.isRunning() && writeCarry()) return;
  const hardware::IoStatus status = outputs_.down();
  if (carried) report_.written.store(status == hardware::IoStatus::Ok);
  hand_over_ = GuardianHandOver();
  setActs(false);
}

void Guardian::handOver(rt::Nanoseconds now) noexcept {
  GuardianHandOver::Counts counts{};
  const hardware::IoStatus status = outputs_.readCounts(counts);
  const bool read = status == hardware::IoStatus::Ok;
  if (read || status == hardware::IoStatus::NotReady)
    hand_over_.step(now, read ? &counts : nullptr);
  else
    hand_over_.begin(now, carry_.time, slip_);  // when the card answers again
  report_.slipped.store(hand_over_.slipped());
}

/// Also in the link: whoever else brings outputs down has to wait for it.
void Guardian::setActs(bool acts) noexcept {
  report_.acts.store(acts);
  link_.acts.store(acts ? 1 : 0);
}

/// The fence first: a controller that wakes up now must not write behind the guardian's back.
void Guardian::trip() noexcept {
  setActs(true);
  report_.slipped.store(0);
  link_.tripped.store(1);
  const rt::Nanoseconds began = clock_();
  const bool carries = (watch_.hasHeard() || isLately(link_.carried_at_ns)) &&
                       link_.carries.load(std::memory_order_acquire) != 0 && carryLoad();
  const hardware::IoStatus status = carries ? hardware::IoStatus::Ok : outputs_.down();
  const rt::Nanoseconds down = clock_();
  if (!carries) setActs(false);
  report_.carried.store(carries ? carry_.time : 0);
  report_.cause.store(watch_.cause());
  report_.controller_pid.store(link_.controller_pid.load());
  report_.reaction.store(down - watch_.lastHeartbeat());
  report_.writing.store(down - began);
  report_.written.store(carries ? orders_ : status == hardware::IoStatus::Ok);
  report_.trips.fetch_add(1, std::memory_order_release);
}

}  // namespace knee_robot::control
