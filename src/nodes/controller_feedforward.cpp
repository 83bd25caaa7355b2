#include "controller_feedforward.h"

#include <knee_robot/FeedforwardConfig.h>

#include "knee_robot/control/model_feedforward.h"
#include "live_config.h"

namespace knee_robot::nodes {

class ControllerFeedforward::Server : public LiveConfig<FeedforwardConfig> {
  using LiveConfig::LiveConfig;
};

ControllerFeedforward::ControllerFeedforward(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log) {
  using C = FeedforwardConfig;
  for (const auto& component : system.deployment().components()) {
    const auto* part = dynamic_cast<const control::ModelFeedforward*>(component.get());
    if (part == nullptr) continue;
    const std::vector<Server::Entry> entries = {{part, "share_gravity", &part->share_gravity, &C::share_gravity},
                                                {part, "share_inertia", &part->share_inertia, &C::share_inertia},
                                                {part, "share_friction", &part->share_friction, &C::share_friction},
                                                {part, "payload_kg", &part->payload, &C::payload_kg}};
    server_ = std::make_unique<Server>(node, "feedforward", system, log, entries);
    return;
  }
}
ControllerFeedforward::~ControllerFeedforward() = default;

}  // namespace knee_robot::nodes
