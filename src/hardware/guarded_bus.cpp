#include "knee_robot/hardware/guarded_bus.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "knee_robot/hardware/process_watch.h"

namespace knee_robot::hardware {
namespace {

constexpr int kPatience_ms = 300;

template <typename Condition>
bool waitFor(Condition&& condition) {
  for (int i = 0; i < kPatience_ms; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return condition();
}

}  // namespace

std::int64_t monotonicTime() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

GuardedBus::GuardedBus(AxisBus& bus, GuardianLink& link, std::uint8_t power_bits, Options options)
    : bus_(bus), link_(link), power_bits_(power_bits), options_(options) {}

std::int64_t GuardedBus::allowedSilence() const noexcept {
  return std::max(link_.silence_ns.load(), options_.guardian_silence_ns);
}

/// One of several that start at once gets the robot.
std::int32_t GuardedBus::claim() noexcept {
  std::int32_t other = link_.controller_pid.load();
  while (other != ::getpid()) {
    if (other > 0 && !ProcessWatch().isGone(other)) return other;
    if (link_.controller_pid.compare_exchange_strong(other, ::getpid())) break;
  }
  return 0;
}

/// What a dead controller has left switched on goes first, whether a guardian answers or not, but for what a guardian
/// hands over to the brakes; until it is off the link says armed.
std::string GuardedBus::takeOver() {
  if (const std::int32_t other = claim())
    return "process " + std::to_string(other) + " already controls this robot; end it first.";
  if (!letGuardianHandOver(link_)) {
    return "the guardian still lets the drives carry the platform: a holding brake does not hold, or cannot be ordered "
           "to; support the platform, then end the guardian.";
  }
  link_.carries.store(0);
  if (options_.outputs != nullptr && options_.outputs->down() != IoStatus::Ok)
    return "the outputs of an earlier controller cannot be brought down: a card refuses.";
  link_.acts.store(0);  // of a guardian that has died of it: the next one has nothing to go on with
  return "";
}

SelfTest GuardedBus::selfTest() {
  if (const std::string refusal = takeOver(); !refusal.empty()) return {false, {refusal}};
  SelfTest result;
  if (options_.outputs == nullptr) result = bus_.selfTest();
  if (options_.outputs == nullptr && !result.passed) return result;
  link_.armed.store(0);
  if (reclaim() != IoStatus::Ok) {
    return {false,
            {"no guardian answers; start it (guardian) before the controller; one that runs has another link, "
             "or its link was removed: end it first. The outputs are down."}};
  }
  if (options_.machine != 0 && link_.machine.load() != options_.machine)
    return {false,
            {"the guardian that answers guards another machine: give both the same hardware file, and each machine a "
             "link of its own."}};
  if (options_.wiring != 0 && link_.wiring.load() != options_.wiring)
    return {false,
            {"the guardian that answers knows other outputs or brakes than this hardware file, which has changed since "
             "it was started: end the guardian and start it again."}};
  if (options_.outputs != nullptr) result = bus_.selfTest();
  result.findings.insert(result.findings.begin(), "guardian: watches.");
  return result;
}

IoStatus GuardedBus::read(AxisFeedback& feedback) noexcept {
  listen();
  return bus_.read(feedback);
}

/// A pause of this process counts as one step: a guardian that could not run either is not to blame for it.
void GuardedBus::listen() noexcept {
  const std::uint64_t cycles = link_.guardian_cycles.load(std::memory_order_acquire);
  const std::int64_t now = options_.clock();
  const bool moved = last_read_ns_ == 0 || cycles != guardian_cycles_;
  silence_ns_ = moved ? 0 : silence_ns_ + std::min(now - last_read_ns_, kLongestStep_ns);
  guardian_cycles_ = cycles;
  last_read_ns_ = now;
}

BusFailure GuardedBus::failure() const noexcept {
  BusFailure failure = bus_.failure();  // what is wrong with the drives decides how to stop, and comes first
  if (failure.fault == BusFault::None && silence_ns_ >= options_.guardian_silence_ns)
    failure.fault = BusFault::GuardianSilent;
  return failure;
}

bool GuardedBus::isFencedOut() const noexcept {
  return link_.tripped.load(std::memory_order_acquire) != 0;
}

IoStatus GuardedBus::reclaim() {
  letGuardianHandOver(link_);
  const std::uint32_t number = link_.reset_request.fetch_add(1) + 1;
  // Or a later one: two may ask at once, and the guardian answers the newest.
  const auto granted = [&] {
    return static_cast<std::int32_t>(link_.reset_done.load() - number) >= 0 && !isFencedOut();
  };
  return waitFor(granted) ? IoStatus::Ok : IoStatus::FencedOut;
}

bool GuardedBus::isCarriedByGuardian() const noexcept {
  return isFencedOut() && link_.acts.load() != 0;
}

void GuardedBus::watchBrakes(const BrakeWatch& watch) noexcept {
  for (std::size_t i = 0; i < watch.slip_counts.size(); ++i) {
    link_.slip_counts[i].store(watch.slip_counts[i]);
    link_.counts_per_mm[i].store(watch.counts_per_mm[i]);
  }
}

void GuardedBus::offerLoad(const std::array<double, kAxes>* volts) noexcept {
  for (std::size_t i = 0; volts != nullptr && i < volts->size(); ++i)
    link_.load_V[i].store((*volts)[i], std::memory_order_relaxed);
  if (volts != nullptr) link_.carried_at_ns.store(options_.clock(), std::memory_order_relaxed);
  link_.carries.store(volts != nullptr ? 1 : 0, std::memory_order_release);
}

IoStatus GuardedBus::writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept {
  return isFencedOut() ? IoStatus::FencedOut : bus_.writeVolts(volts, written);
}

/// Armed before the drives get power, disarmed after they have lost it, so that there is no moment without a guard.
IoStatus GuardedBus::writeOutputs(std::uint8_t bits) noexcept {
  link_.heartbeat.fetch_add(1, std::memory_order_release);
  const bool power = (bits & power_bits_) != 0;
  if (power) link_.armed.store(1);
  const bool fenced = isFencedOut();
  const IoStatus status = fenced ? IoStatus::FencedOut : bus_.writeOutputs(bits);
  // Fenced out, the guardian keeps the outputs down: wanting nothing any more is all that a reset asks for.
  if (!power && (fenced || status == IoStatus::Ok)) link_.armed.store(0);
  return status;
}

}  // namespace knee_robot::hardware
