#include "controller_feedforward.h"

#include <dynamic_reconfigure/server.h>
#include <knee_robot/FeedforwardConfig.h>
#include <ros/ros.h>

#include <array>

#include "knee_robot/base/numbers.h"
#include "knee_robot/control/model_feedforward.h"

namespace knee_robot::nodes {
namespace {

struct Part {
  const char* property;
  rt::Property<double> control::ModelFeedforward::*value;
  double FeedforwardConfig::*field;
};

const std::array<Part, 4>& parts() {
  static const std::array<Part, 4> table = {{
      {"share_gravity", &control::ModelFeedforward::share_gravity, &FeedforwardConfig::share_gravity},
      {"share_inertia", &control::ModelFeedforward::share_inertia, &FeedforwardConfig::share_inertia},
      {"share_friction", &control::ModelFeedforward::share_friction, &FeedforwardConfig::share_friction},
      {"payload_kg", &control::ModelFeedforward::payload, &FeedforwardConfig::payload_kg},
  }};
  return table;
}

const control::ModelFeedforward* find(const control::ControlSystem& system) {
  for (const auto& component : system.deployment().components()) {
    if (const auto* found = dynamic_cast<const control::ModelFeedforward*>(component.get())) return found;
  }
  return nullptr;
}

}  // namespace

class ControllerFeedforward::Server {
 public:
  Server(ros::NodeHandle& node, control::ControlSystem& system, const control::ModelFeedforward& component,
         EventLog& log)
      : system_(system), log_(log), component_(component), server_(mutex_, ros::NodeHandle(node, "feedforward")) {
    FeedforwardConfig config;
    server_.getConfigDefault(config);
    readBack(config);
    server_.setConfigDefault(config);
    server_.updateConfig(config);
    server_.setCallback([this](FeedforwardConfig& asked, std::uint32_t) { change(asked); });
  }

 private:
  void change(FeedforwardConfig& asked) {
    for (const Part& part : parts()) {
      const double wanted = asked.*part.field;
      if (wanted == (component_.*part.value).value()) continue;
      const control::Answer answer = system_.setProperty(component_.name(), part.property, exactNumber(wanted));
      log_.request("", "feedforward (dynamic_reconfigure)", answer);
      if (answer.ok) ROS_INFO("feedforward: %s", answer.sentence.c_str());
      if (!answer.ok) ROS_WARN("feedforward refused: %s", answer.sentence.c_str());
    }
    readBack(asked);
  }

  void readBack(FeedforwardConfig& config) const {
    for (const Part& part : parts())
      config.*part.field = (component_.*part.value).value();
  }

  control::ControlSystem& system_;
  EventLog& log_;
  const control::ModelFeedforward& component_;
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<FeedforwardConfig> server_;
};

ControllerFeedforward::ControllerFeedforward(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log) {
  if (const control::ModelFeedforward* component = find(system))
    server_ = std::make_unique<Server>(node, system, *component, log);
}
ControllerFeedforward::~ControllerFeedforward() = default;

}  // namespace knee_robot::nodes
