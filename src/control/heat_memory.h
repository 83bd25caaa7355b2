#pragma once

#include <string>
#include <utility>

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
/// executes it: write() is one of the Chores, and the end writes, too. A disk that refuses is not an error of the
/// motion. One that is full has no room for a new file: the old one is written over.
class HeatMemory : public rt::TaskContext {
 public:
  rt::InputPort<MonitorVerdict> verdict{*this, "verdict", "from Monitors"};

  /// An empty path: no heat is kept.
  explicit HeatMemory(std::string path) : rt::TaskContext("HeatMemory"), path_(std::move(path)) {}
  ~HeatMemory() override { write(); }

  /// What the Monitors have said last. Not from two threads at once.
  void write() noexcept;

 private:
  const std::string path_;
};

}  // namespace knee_robot::control
