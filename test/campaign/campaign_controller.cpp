// The product's controller (src/nodes/controller_main.cpp, the same libraries), linked so that its component factory
// gives components which misbehave when the fault campaign orders it (misbehaving.h), and so that its wall clock can be
// set. The linker's --wrap puts these between; nothing of this is in the product.

#include <dlfcn.h>
#include <time.h>

#include <cstdlib>
#include <memory>

#include "knee_robot/base/errors.h"
#include "knee_robot/control/component_types.h"
#include "test/campaign/misbehaving.h"

namespace knee_robot::campaign {
namespace {
std::atomic<simulation::RobotImage*> attached{nullptr};
constexpr std::uint32_t kClockForward = 901;  // orders in component_fault
constexpr std::uint32_t kClockBackward = 902;
constexpr time_t kStep_s = 3600;
}  // namespace

simulation::RobotImage& image() {
  static simulation::SharedImage* memory = nullptr;
  if (memory == nullptr) {
    const char* name = std::getenv("KNEE_CAMPAIGN_SHM");
    if (name == nullptr)
      throw InputError("KNEE_CAMPAIGN_SHM is not set: this controller is for scripts/fault_campaign");
    memory = new simulation::SharedImage(simulation::SharedImage::attach(name));
    attached.store(&memory->image());
  }
  return memory->image();
}

rt::TypeFactory productTypes(const mechanism::Robot& robot, const control::HardwareFile& hardware,
                             hardware::AxisBus& bus,
                             const control::AxisValues& lengths_at_start) __asm__("__real_" KNEE_FACTORY);

rt::TypeFactory campaignTypes(const mechanism::Robot& robot, const control::HardwareFile& hardware,
                              hardware::AxisBus& bus,
                              const control::AxisValues& lengths_at_start) __asm__("__wrap_" KNEE_FACTORY);

rt::TypeFactory campaignTypes(const mechanism::Robot& robot, const control::HardwareFile& hardware,
                              hardware::AxisBus& bus, const control::AxisValues& lengths_at_start) {
  using Name = const std::string&;
  rt::TypeFactory types = productTypes(robot, hardware, bus, lengths_at_start);
  types["AxesInput"] = [=, &bus](Name name) {
    return std::make_unique<Misbehaving<control::AxesInput, Part::AxesInput>>(name, robot, bus, lengths_at_start);
  };
  types["Sync"] = [=](Name name) { return std::make_unique<Misbehaving<control::Sync, Part::Sync>>(name, robot); };
  types["Driver"] = [=](Name name) {
    return std::make_unique<Misbehaving<control::Driver, Part::Driver>>(name, robot, hardware);
  };
  types["Supervisor"] = [=](Name name) {
    return std::make_unique<Misbehaving<control::Supervisor, Part::Supervisor>>(name, robot, hardware);
  };
  types["AxesOutput"] = [=, &bus](Name name) {
    return std::make_unique<Misbehaving<control::AxesOutput, Part::AxesOutput>>(name, robot, hardware, bus);
  };
  types["Recorder"] = [](Name name) { return std::make_unique<Misbehaving<control::Recorder, Part::Recorder>>(name); };
  return types;
}

}  // namespace knee_robot::campaign

/// The wall clock of this process, an hour off when ordered: what a step by ntpd or by hand looks like from inside. In
/// place of the C library's for this program and its shared libraries.
extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  using Function = int (*)(clockid_t, timespec*);
  static const auto real = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "clock_gettime"));
  const int status = real(clock, time);
  const auto* image = knee_robot::campaign::attached.load(std::memory_order_acquire);
  if (clock == CLOCK_REALTIME && image != nullptr) {
    const std::uint32_t order = image->faults.component_fault.load(std::memory_order_relaxed);
    if (order == knee_robot::campaign::kClockForward) time->tv_sec += knee_robot::campaign::kStep_s;
    if (order == knee_robot::campaign::kClockBackward) time->tv_sec -= knee_robot::campaign::kStep_s;
  }
  return status;
}
