#include "heat_memory.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/strict_yaml.h"

namespace knee_robot::control {
namespace {

constexpr double kHottest = 10.0;  // beyond any that a monitor lets happen

/// Of a file of before the boot was written down: the wall clock alone.
Moment writtenAt(StrictMap& file) {
  Moment then;
  then.wall_s = file.number("time_s", 0.0, 1e11);
  then.boot = file.textOr("boot", "");
  if (!then.boot.empty()) then.since_boot_s = file.number("since_boot_s", 0.0, 1e11);
  then.synchronized = file.flagOr("clock_synchronized", false);
  return then;
}

/// In the place of the old content, which a full disk still has room for. What a power cut leaves of it counts as hot.
void overwrite(const std::string& path, const std::string& text) noexcept {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return;
  const bool whole = ::pwrite(file, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (whole && ::ftruncate(file, static_cast<off_t>(text.size())) == 0 && ::fdatasync(file) != 0) {
    // on the disk a little later
  }
  ::close(file);
}

}  // namespace

AxisValues rememberedHeat(const std::string& path, const Moment& now, double time_constant_s, std::string* error) {
  AxisValues heat{};
  if (path.empty() || ::access(path.c_str(), F_OK) != 0) return heat;
  try {
    StrictMap file = StrictMap::parse(readFile(path, 4096), path);
    const std::vector<double> kept = file.numbers("heat", hardware::kAxes, 0.0, kHottest);
    const Moment written = writtenAt(file);
    file.finish();
    const double cooling = std::exp(-leastSecondsBetween(written, now) / time_constant_s);
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      heat[i] = std::min(1.0, kept[i] * cooling);
  } catch (const InputError& refused) {
    if (error != nullptr) *error = refused.what();
    heat.fill(1.0);
  }
  return heat;
}

void HeatMemory::write() noexcept {
  MonitorVerdict newest;
  if (path_.empty() || verdict.read(newest) == rt::FlowStatus::NoData) return;
  try {
    std::string text =
        "# Heat of the motors (I2t: 1 is what the continuous force leads to), for the next start.\nheat: [";
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      text += (i == 0 ? "" : ", ") + exactNumber(std::clamp(newest.heat[i], 0.0, kHottest));
    const Moment now = momentNow();
    text += "]\ntime_s: " + exactNumber(now.wall_s) + "\n";
    if (!now.boot.empty()) text += "boot: " + now.boot + "\nsince_boot_s: " + exactNumber(now.since_boot_s) + "\n";
    text += std::string("clock_synchronized: ") + (now.synchronized ? "true" : "false") + "\n";
    makeFolder(path_.substr(0, path_.find_last_of('/')));
    try {
      writeFileAtomically(path_, text);
    } catch (const InputError&) {  // an old file would tell the next start of motors as cold as they were then
      overwrite(path_, text);
    }
  } catch (const std::exception&) {
    // see the class: the next start finds the older file
  }
}

}  // namespace knee_robot::control
