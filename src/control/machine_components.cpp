#include "machine_components.h"

#include <algorithm>
#include <iterator>

#include "knee_robot/base/errors.h"

namespace knee_robot::control {
namespace {

template <typename Component>
Component* atMostOne(const rt::Deployment& deployment, const char* type) {
  Component* found = nullptr;
  for (const auto& component : deployment.components()) {
    auto* one = dynamic_cast<Component*>(component.get());
    if (one == nullptr) continue;
    if (found != nullptr) throw InputError(deployment.path() + ": components: there must be one " + type + ", not two");
    found = one;
  }
  return found;
}

template <typename Component>
Component* only(const rt::Deployment& deployment, const char* type) {
  Component* found = atMostOne<Component>(deployment, type);
  if (found == nullptr) throw InputError(deployment.path() + ": components: there is no " + type + "; add one");
  return found;
}

}  // namespace

MachineComponents::MachineComponents(const rt::Deployment& deployment)
    : sync(only<Sync>(deployment, "Sync")),
      recorder(only<Recorder>(deployment, "Recorder")),
      supervisor(only<Supervisor>(deployment, "Supervisor")),
      input(only<AxesInput>(deployment, "AxesInput")),
      output(only<AxesOutput>(deployment, "AxesOutput")),
      monitors(only<Monitors>(deployment, "Monitors")),
      black_box(only<BlackBox>(deployment, "BlackBox")),
      feedforward(atMostOne<ModelFeedforward>(deployment, "ModelFeedforward")),
      observer(atMostOne<DisturbanceObserver>(deployment, "DisturbanceObserver")),
      guide(atMostOne<HandGuide>(deployment, "HandGuide")) {
  for (const auto& component : deployment.components()) {
    if (auto* driver = dynamic_cast<Driver*>(component.get())) drivers.push_back(driver);
  }
  checkDrivers(deployment);
  checkOrder(deployment);
}

void MachineComponents::checkDrivers(const rt::Deployment& deployment) const {
  for (int axis = 1; axis <= hardware::kAxes; ++axis) {
    const auto count = std::count_if(drivers.begin(), drivers.end(),
                                     [&](const Driver* driver) { return driver->axis.value() == axis; });
    if (count == 1) continue;
    throw InputError(deployment.path() + ": components: axis " + std::to_string(axis) + " has " +
                     std::to_string(count) + " Drivers; it needs one");
  }
}

/// One thread uses the bus; what is read in a cycle is answered in the same cycle, and a row of the recording is of one
/// cycle.
void MachineComponents::checkOrder(const rt::Deployment& deployment) const {
  const std::string where = deployment.path() + ": components: ";
  const rt::Activity* servo = deployment.activityOf(*input);
  const std::vector<rt::TaskContext*>& order = servo->components();
  const auto position = [&](const rt::TaskContext* component) {
    return std::find(order.begin(), order.end(), component);
  };
  const rt::TaskContext* together[] = {output, recorder, supervisor, monitors, black_box};
  if (std::any_of(std::begin(together), std::end(together),
                  [&](const auto* one) { return position(one) == order.end(); })) {
    throw InputError(where +
                     "AxesInput, Monitors, Supervisor, AxesOutput, Recorder and BlackBox must belong to one activity");
  }
  if (position(input) != order.begin())
    throw InputError(where + "AxesInput must be the first of activity " + servo->name());
  for (auto after = position(monitors); after != order.end(); ++after) {
    if (dynamic_cast<const Driver*>(*after) != nullptr)
      throw InputError(where + "Monitors must come after the Drivers");
  }
  const auto is_driver = [](const rt::TaskContext* one) { return dynamic_cast<const Driver*>(one) != nullptr; };
  const bool too_late =
      feedforward != nullptr && std::find_if(order.begin(), order.end(), is_driver) < position(feedforward);
  if (too_late) throw InputError(where + "ModelFeedforward must come before the Drivers, in their activity");
  const bool observes_late =
      observer != nullptr && std::find_if(order.begin(), order.end(), is_driver) < position(observer);
  if (observes_late) throw InputError(where + "DisturbanceObserver must come before the Drivers, in their activity");
  const bool guides_late = guide != nullptr && std::find_if(order.begin(), order.end(), is_driver) < position(guide);
  if (guides_late) throw InputError(where + "HandGuide must come before the Drivers, in their activity");
  if (position(supervisor) < position(monitors)) throw InputError(where + "Supervisor must come after Monitors");
  for (auto after = position(output); after != order.end(); ++after) {
    if (dynamic_cast<const Driver*>(*after) != nullptr || *after == supervisor) {
      throw InputError(where + "AxesOutput must come after the Supervisor and the Drivers of its activity");
    }
  }
  if (position(recorder) < position(output) || position(black_box) < position(output))
    throw InputError(where + "Recorder and BlackBox must come after AxesOutput");
}

}  // namespace knee_robot::control
