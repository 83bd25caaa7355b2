#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/rt/port.h"
#include "moment.h"

namespace knee_robot::control {

/// What the motors' heat (I2t, 0 to 1) was when a controller wrote it last, and by now: less by the cooling in
/// leastSecondsBetween() (moment.h), so that a clock that was set leaves nobody with motors that count as colder than
/// they are. A file that is missing: cold. One that cannot be understood: hot (1), because it is not known; `error`,
/// when given, gets the sentence.
AxisValues rememberedHeat(const std::string& path, const Moment& now, double time_constant_s,
                          std::string* error = nullptr);

/// Keeps the heat in a file, so that a controller that is started anew does not believe in cold motors. No activity
/// executes it: an ordinary thread reads the Monitors' verdicts and writes every two seconds and at the end. A disk
/// that refuses is not an error of the motion; the next start finds an older file, and heat that was higher or lower by
/// two seconds' worth.
class HeatMemory : public rt::TaskContext {
 public:
  static constexpr double kPeriod_s = 2.0;

  rt::InputPort<MonitorVerdict> verdict{*this, "verdict", "from Monitors"};

  /// An empty path: no heat is kept. `threaded`: with an own thread; otherwise only the end writes. `beside`: what else
  /// is to be done by it in every period.
  HeatMemory(std::string path, bool threaded, std::function<void()> beside = nullptr);
  ~HeatMemory() override;

 private:
  void loop();
  void write() noexcept;

  const std::string path_;
  const std::function<void()> beside_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace knee_robot::control
