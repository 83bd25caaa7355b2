#include "controller_gains.h"

#include <dynamic_reconfigure/server.h>
#include <knee_robot/GainsConfig.h>
#include <ros/ros.h>

#include "knee_robot/base/numbers.h"
#include "knee_robot/control/driver.h"

namespace knee_robot::nodes {
namespace {

struct Gain {
  const char* property;
  rt::Property<double> control::Driver::*value;
  std::array<double GainsConfig::*, hardware::kAxes> field;
};

const std::array<Gain, 4>& gains() {
  using C = GainsConfig;
  static const std::array<Gain, 4> table = {{
      {"proportional_N_per_m",
       &control::Driver::proportional,
       {&C::proportional_1, &C::proportional_2, &C::proportional_3, &C::proportional_4}},
      {"integral_N_per_m_s",
       &control::Driver::integral,
       {&C::integral_1, &C::integral_2, &C::integral_3, &C::integral_4}},
      {"derivative_N_s_per_m",
       &control::Driver::derivative,
       {&C::derivative_1, &C::derivative_2, &C::derivative_3, &C::derivative_4}},
      {"derivative_cutoff_hz",
       &control::Driver::derivative_cutoff,
       {&C::derivative_cutoff_1, &C::derivative_cutoff_2, &C::derivative_cutoff_3, &C::derivative_cutoff_4}},
  }};
  return table;
}

}  // namespace

class ControllerGains::Server {
 public:
  Server(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log)
      : system_(system), log_(log), server_(mutex_, ros::NodeHandle(node, "gains")) {
    GainsConfig config;
    server_.getConfigDefault(config);
    readBack(config);
    server_.setConfigDefault(config);
    server_.updateConfig(config);
    server_.setCallback([this](GainsConfig& asked, std::uint32_t) { change(asked); });
  }

 private:
  void change(GainsConfig& asked) {
    for (const auto& component : system_.deployment().components()) {
      const auto* driver = dynamic_cast<const control::Driver*>(component.get());
      if (driver == nullptr) continue;
      const auto axis = static_cast<std::size_t>(driver->axis.value()) - 1;
      for (const Gain& gain : gains()) {
        const double wanted = asked.*gain.field[axis];
        if (wanted == (driver->*gain.value).value()) continue;
        const control::Answer answer = system_.setProperty(driver->name(), gain.property, exactNumber(wanted));
        log_.request("", "gains (dynamic_reconfigure)", answer);
        if (answer.ok) ROS_INFO("gains: %s", answer.sentence.c_str());
        if (!answer.ok) ROS_WARN("gains refused: %s", answer.sentence.c_str());
      }
    }
    readBack(asked);
  }

  void readBack(GainsConfig& config) const {
    for (const auto& component : system_.deployment().components()) {
      const auto* driver = dynamic_cast<const control::Driver*>(component.get());
      if (driver == nullptr) continue;
      for (const Gain& gain : gains())
        config.*gain.field[static_cast<std::size_t>(driver->axis.value()) - 1] = (driver->*gain.value).value();
    }
  }

  control::ControlSystem& system_;
  EventLog& log_;
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<GainsConfig> server_;
};

ControllerGains::ControllerGains(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log)
    : server_(std::make_unique<Server>(node, system, log)) {}
ControllerGains::~ControllerGains() = default;

}  // namespace knee_robot::nodes
