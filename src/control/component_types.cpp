#include "knee_robot/control/component_types.h"

#include "axes_input.h"
#include "axes_output.h"
#include "black_box.h"
#include "disturbance_observer.h"
#include "hand_guide.h"
#include "knee_robot/control/driver.h"
#include "knee_robot/control/model_feedforward.h"
#include "monitors.h"
#include "recorder.h"
#include "supervisor.h"
#include "sync.h"

namespace knee_robot::control {

rt::TypeFactory componentTypes(const mechanism::Robot& robot, const HardwareFile& hardware, hardware::AxisBus& bus,
                               const AxisValues& lengths_at_start) {
  using Name = const std::string&;
  rt::TypeFactory types;
  types["AxesInput"] = [=, &bus](Name name) { return std::make_unique<AxesInput>(name, robot, bus, lengths_at_start); };
  types["Sync"] = [=](Name name) { return std::make_unique<Sync>(name, robot); };
  types["Driver"] = [=](Name name) { return std::make_unique<Driver>(name, robot, hardware); };
  types["ModelFeedforward"] = [=](Name name) { return std::make_unique<ModelFeedforward>(name, robot); };
  types["DisturbanceObserver"] = [=](Name name) { return std::make_unique<DisturbanceObserver>(name, robot); };
  types["HandGuide"] = [=](Name name) { return std::make_unique<HandGuide>(name, robot); };
  types["Monitors"] = [=](Name name) { return std::make_unique<Monitors>(name, robot); };
  types["Supervisor"] = [=](Name name) { return std::make_unique<Supervisor>(name, robot, hardware); };
  types["AxesOutput"] = [=, &bus](Name name) { return std::make_unique<AxesOutput>(name, robot, hardware, bus); };
  types["BlackBox"] = [](Name name) { return std::make_unique<BlackBox>(name); };
  types["Recorder"] = [](Name name) { return std::make_unique<Recorder>(name); };
  return types;
}

}  // namespace knee_robot::control
