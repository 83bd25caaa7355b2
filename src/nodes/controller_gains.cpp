#include "controller_gains.h"

#include <knee_robot/GainsConfig.h>

#include "knee_robot/control/driver.h"
#include "live_config.h"

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

class ControllerGains::Server : public LiveConfig<GainsConfig> {
  using LiveConfig::LiveConfig;
};

ControllerGains::ControllerGains(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log) {
  std::vector<Server::Entry> entries;
  for (const auto& component : system.deployment().components()) {
    const auto* driver = dynamic_cast<const control::Driver*>(component.get());
    if (driver == nullptr) continue;
    const auto axis = static_cast<std::size_t>(driver->axis.value()) - 1;
    for (const Gain& gain : gains())
      entries.push_back({driver, gain.property, &(driver->*gain.value), gain.field[axis]});
  }
  server_ = std::make_unique<Server>(node, "gains", system, log, entries);
}
ControllerGains::~ControllerGains() = default;

}  // namespace knee_robot::nodes
