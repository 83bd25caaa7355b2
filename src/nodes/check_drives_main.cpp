// check_drives --hardware H --robot R: are the CAN drives there, are they the described ones, do they answer in time?
// Prints every step of the self test, the bus load, and how the cyclic exchange went. Nothing moves: torque stays 0,
// holding brakes engaged.

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "backends.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/hardware/can/can_axis_bus.h"
#include "knee_robot/hardware/machine_lock.h"
#include "program.h"

namespace {

using namespace knee_robot;
using namespace knee_robot::hardware;

struct Options {
  std::string hardware, robot, bus;
  double seconds = 1.0;
  bool enable = false;
};

/// One line for a failure, empty when there is none.
std::string describe(const BusFailure& failure) {
  if (failure.fault == BusFault::None) return "";
  std::string text = control::describe(control::faultOf(failure.fault)).sentence;
  if (failure.axis > 0) text = "axis " + std::to_string(failure.axis) + ": " + text;
  if (failure.code != 0) text += std::string(" (") + can::emergencyText(failure.code) + ")";
  return text;
}

void sleepUntil(std::int64_t deadline) {
  const timespec time{deadline / 1'000'000'000LL, deadline % 1'000'000'000LL};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr);
}

/// The cyclic exchange at torque 0 for some seconds. Throws Refusal at the first failure.
class Exchange {
 public:
  Exchange(can::CanAxisBus& bus, const can::CanSettings& settings) : bus_(bus), settings_(settings) { next_ = now(); }

  void run(double seconds, bool enable) {
    const auto cycles = std::llround(seconds / settings_.period_s);
    for (long long i = 0; i < cycles; ++i) {
      sleep();
      AxisFeedback feedback;
      const IoStatus status = bus_.read(feedback);
      require(status);
      std::array<double, kAxes> written{};
      require(bus_.writeVolts({}, written));
      require(bus_.writeOutputs(static_cast<std::uint8_t>(enable ? 1u << settings_.drive_enable_bit : 0u)));
      counts_ = feedback.counts;
      ++cycles_;
    }
  }
  /// For the end, whatever happened before.
  void switchOff() noexcept {
    std::array<double, kAxes> written{};
    for (int i = 0; i < 5; ++i) {
      bus_.writeOutputs(0);
      bus_.writeVolts({}, written);
      sleep();
    }
  }
  long long cycles() const { return cycles_; }
  const std::array<std::int32_t, kAxes>& counts() const { return counts_; }

 private:
  static std::int64_t now() {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
  }
  /// Until the next period; after a pause of this process what was missed is left out, never caught up.
  void sleep() {
    const std::int64_t period = std::llround(settings_.period_s * 1e9);
    next_ += period;
    if (const std::int64_t late = now() - next_; late > 0) next_ += (late / period + 1) * period;
    sleepUntil(next_);
  }
  void require(IoStatus status) {
    const std::string failure = describe(bus_.failure());
    if (!failure.empty()) throw Refusal("after " + std::to_string(cycles_) + " cycles: " + failure);
    if (status != IoStatus::Ok) throw Refusal("after " + std::to_string(cycles_) + " cycles: " + toText(status));
  }

  can::CanAxisBus& bus_;
  const can::CanSettings& settings_;
  std::int64_t next_ = 0;
  long long cycles_ = 0;
  std::array<std::int32_t, kAxes> counts_{};
};

int check(const Options& options) {
  const mechanism::Robot robot = mechanism::loadRobot(options.robot);
  control::HardwareFile hardware = control::loadHardwareFile(options.hardware);
  if (!hardware.can) throw InputError(options.hardware + ": backend: must be can for drives on a CAN bus");
  can::CanSettings& settings = *hardware.can;
  if (!options.bus.empty()) settings.interface = options.bus;
  // The self test switches drives off: not under a controller that moves somebody.
  const nodes::Site site;
  const MachineLock lock = MachineLock::take("controller", nodes::machineName(hardware, site));
  const auto process = can::CanSocket::open(settings.interface, can::processFilters(settings));
  const auto service = can::CanSocket::open(settings.interface, can::serviceFilters(settings));
  can::CanAxisBus bus(*process, *service, settings, control::canUnits(robot));
  const SelfTest test = bus.selfTest();
  for (const std::string& finding : test.findings)
    std::printf("%s\n", finding.c_str());
  std::fflush(stdout);
  if (!test.passed) throw Refusal(test.findings.back());
  Exchange exchange(bus, settings);
  try {
    exchange.run(options.seconds, false);
    if (options.enable) {
      exchange.run(std::max(options.seconds, 1.5 * settings.enable_delay_s), true);
      std::printf("all four drives are in Operation Enabled, torque 0.\n");
    }
  } catch (const Refusal&) {
    exchange.switchOff();
    throw;
  }
  exchange.switchOff();
  std::printf("%lld cycles of %g ms, no failure; counts %d %d %d %d\n", exchange.cycles(), 1e3 * settings.period_s,
              exchange.counts()[0], exchange.counts()[1], exchange.counts()[2], exchange.counts()[3]);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Checks CAN drives: identity, limits, cyclic exchange. Nothing moves.", "check_drives");
  Options options;
  app.option("--hardware", options.hardware, "hardware file (YAML) with backend can").required();
  app.option("--robot", options.robot, "robot file (YAML)").required();
  app.option("--bus", options.bus, "CAN interface or simulated bus' path; default: the hardware file's");
  app.option("--seconds", options.seconds, "duration of the cyclic exchange").within(0.01, 3600.0).showDefault();
  app.flag("--enable", options.enable, "also switch the drives on, at torque 0, holding brakes engaged");
  return nodes::runProgram(app, argc, argv, [&] { return check(options); });
}
