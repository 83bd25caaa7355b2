#pragma once

#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>

#include <string>
#include <utility>
#include <vector>

#include "event_log.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/control/control_system.h"
#include "terminal.h"

namespace knee_robot::nodes {

/// Properties of components under dynamic_reconfigure: what is answered is what the components have.
template <typename Config>
class LiveConfig {
 public:
  struct Entry {
    const rt::TaskContext* component;
    const char* property;
    const rt::Property<double>* value;
    double Config::*field;
  };
  LiveConfig(const ros::NodeHandle& node, const std::string& name, control::ControlSystem& system, EventLog& log,
             std::vector<Entry> entries)
      : name_(name),
        system_(system),
        log_(log),
        entries_(std::move(entries)),
        server_(mutex_, ros::NodeHandle(node, name)) {
    Config config;
    server_.getConfigDefault(config);
    readBack(config);
    shown_ = config;
    server_.setConfigDefault(config);
    server_.updateConfig(config);
    server_.setCallback([this](Config& asked, std::uint32_t) { change(asked); });
  }

 private:
  void change(Config& asked) {
    for (const Entry& one : entries_) {
      const double wanted = asked.*one.field;
      // The others are what the server showed last; set_property, or another patient, may have changed them since.
      if (wanted == shown_.*one.field || wanted == one.value->value()) continue;
      const control::Answer answer = system_.setProperty(one.component->name(), one.property, exactNumber(wanted));
      log_.request("", name_ + " (dynamic_reconfigure)", answer);
      showAnswer(name_, answer);
    }
    readBack(asked);
    shown_ = asked;
  }

  void readBack(Config& config) const {
    for (const Entry& one : entries_)
      config.*one.field = one.value->value();
  }

  const std::string name_;
  control::ControlSystem& system_;
  EventLog& log_;
  const std::vector<Entry> entries_;
  Config shown_;
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<Config> server_;
};

}  // namespace knee_robot::nodes
