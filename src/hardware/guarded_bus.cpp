#include "knee_robot/hardware/guarded_bus.h"

#include <unistd.h>

#include <chrono>
#include <thread>

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

GuardedBus::GuardedBus(AxisBus& bus, GuardianLink& link, std::uint8_t power_bits)
    : bus_(bus), link_(link), power_bits_(power_bits) {}

SelfTest GuardedBus::selfTest() {
  const std::int32_t other = link_.controller_pid.load();
  if (other != ::getpid() && processExists(other)) {
    return {false, {"process " + std::to_string(other) + " already controls this robot; end it first."}};
  }
  link_.armed.store(0);
  link_.controller_pid.store(::getpid());
  if (reclaim() != IoStatus::Ok) return {false, {"no guardian answers; start it (guardian) before the controller."}};
  SelfTest result = bus_.selfTest();
  result.findings.insert(result.findings.begin(), "guardian: watches.");
  return result;
}

bool GuardedBus::isFencedOut() const noexcept {
  return link_.tripped.load(std::memory_order_acquire) != 0;
}

IoStatus GuardedBus::reclaim() {
  const std::uint32_t number = link_.reset_request.fetch_add(1) + 1;
  const auto granted = [&] { return link_.reset_done.load() == number && !isFencedOut(); };
  return waitFor(granted) ? IoStatus::Ok : IoStatus::FencedOut;
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
