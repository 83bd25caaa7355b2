#include "deployment_reader.h"

#include <algorithm>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/words.h"
#include "knee_robot/rt/names.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::rt {
namespace {

constexpr double kShortestPeriod_s = 50e-6;
constexpr double kLongestPeriod_s = 10.0;

/// "file:line: key: sentence" from an InputError that knows neither file nor line.
template <typename Call>
void at(const StrictMap& map, const std::string& key, Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    map.refuse(key, error.what());
  }
}

/// The output that an input's name stands for: `x` of another component, or for `x_2` the `x` of a component whose name
/// ends in 2.
bool isMeant(const TaskContext& sender, const PortBase& output, const PortBase& input) {
  if (!output.isOutput() || output.type() != input.type()) return false;
  if (output.name() == input.name()) return true;
  const std::size_t digits = sender.name().find_last_not_of("0123456789") + 1;
  return digits < sender.name().size() && input.name() == output.name() + "_" + sender.name().substr(digits);
}

}  // namespace

DeploymentReader::DeploymentReader(Deployment& target, const TypeFactory& factory)
    : target_(target), factory_(factory), file_(StrictMap::load(target.path_)) {}

void DeploymentReader::read() {
  const bool require_real_time = file_.flagOr("require_real_time", false);
  for (StrictMap& entry : file_.maps("activities"))
    readActivity(entry, require_real_time);
  for (StrictMap& entry : file_.maps("components"))
    readComponent(entry);
  if (file_.has("connections")) {
    for (StrictMap& entry : file_.maps("connections"))
      readConnection(entry);
  }
  connectByName();
  requireConnections();
  readStartOrder();
  file_.finish();
}

void DeploymentReader::readActivity(StrictMap& entry, bool require_real_time) {
  ActivityOptions options;
  options.name = entry.text("name");
  if (target_.activity(options.name) != nullptr) {
    entry.refuse("name", "there are two activities named " + options.name + "; rename one");
  }
  options.period = fromSeconds(entry.number("period_s", kShortestPeriod_s, kLongestPeriod_s));
  options.priority = entry.integerOr("priority", 0, 0, 99);
  options.cpu = entry.integerOr("cpu", -1, -1, 1023);
  options.overrun_limit = entry.integerOr("overrun_limit", options.overrun_limit, 0, 1'000'000);
  options.require_real_time = require_real_time;
  entry.finish();
  if (target_.execution_ == Execution::Stepped) {
    auto activity = std::make_unique<SteppedActivity>(options);
    target_.stepped_.push_back(activity.get());
    target_.activities_.push_back(std::move(activity));
  } else {
    target_.activities_.push_back(std::make_unique<PeriodicActivity>(options));
  }
}

void DeploymentReader::readComponent(StrictMap& entry) {
  const std::string name = entry.text("name");
  if (name.empty() || name.find('.') != std::string::npos) {
    entry.refuse("name", "a component's name is a word without a dot, not '" + name + "'");
  }
  if (target_.component(name) != nullptr) {
    entry.refuse("name", "there are two components named " + name + "; rename one");
  }
  const std::string type = entry.text("type");
  const auto make = factory_.find(type);
  if (make == factory_.end()) {
    entry.refuse("type", "there is no component type " + type + "; there are " +
                             joined(factory_, [](const auto& one) { return one.first; }));
  }
  target_.components_.push_back(make->second(name));
  TaskContext& component = *target_.components_.back();
  if (auto properties = entry.mapIfAny("properties")) loadProperties(component, *properties);

  const std::string activity_name = entry.text("activity");
  Activity* activity = target_.activity(activity_name);
  if (activity == nullptr) {
    entry.refuse("activity", "there is no activity " + activity_name + "; there are " + listNames(target_.activities_));
  }
  const double period = entry.numberOr("period_s", 0.0, kShortestPeriod_s, kLongestPeriod_s);
  at(entry, entry.has("period_s") ? "period_s" : "activity", [&] { activity->add(component, fromSeconds(period)); });
  entry.finish();
}

PortBase& DeploymentReader::findPort(StrictMap& entry, const std::string& key) {
  const std::string full = entry.text(key);
  const std::size_t dot = full.find('.');
  if (dot == std::string::npos) entry.refuse(key, "expected Component.port, not '" + full + "'");
  TaskContext* component = target_.component(full.substr(0, dot));
  if (component == nullptr) {
    entry.refuse(key, "there is no component " + full.substr(0, dot) + "; there are " + listNames(target_.components_));
  }
  PortBase* port = component->port(full.substr(dot + 1));
  if (port == nullptr) {
    entry.refuse(key, "component " + component->name() + " has no port " + full.substr(dot + 1) + "; it has " +
                          listNames(component->ports()));
  }
  return *port;
}

void DeploymentReader::readConnection(StrictMap& entry) {
  PortBase& from = findPort(entry, "from");
  PortBase& to = findPort(entry, "to");
  at(entry, "from", [&] { connect(from, to); });
  entry.finish();
}

std::vector<PortBase*> DeploymentReader::outputsFor(const TaskContext& receiver, const PortBase& input) {
  std::vector<PortBase*> found;
  for (const auto& sender : target_.components_) {
    if (sender.get() == &receiver) continue;
    for (PortBase* output : sender->ports()) {
      if (isMeant(*sender, *output, input)) found.push_back(output);
    }
  }
  return found;
}

void DeploymentReader::connectByName() {
  for (const auto& receiver : target_.components_) {
    for (PortBase* input : receiver->ports()) {
      if (input->isOutput() || input->isConnected()) continue;
      const std::vector<PortBase*> outputs = outputsFor(*receiver, *input);
      if (outputs.size() > 1) {
        file_.refuse("components", "the input " + input->fullName() + " could be connected to " +
                                       outputs[0]->fullName() + " or " + outputs[1]->fullName() +
                                       ": say which under connections");
      }
      if (outputs.size() == 1) connect(*outputs[0], *input);
    }
  }
}

void DeploymentReader::requireConnections() {
  for (const auto& component : target_.components_) {
    for (const PortBase* port : component->ports()) {
      if (!port->isOutput() && port->isRequired() && !port->isConnected()) {
        file_.refuse("components", "the input " + port->fullName() + " (" + port->typeName() +
                                       ") is not connected: no output has its name and type; add {from: ..., to: " +
                                       port->fullName() + "} under connections");
      }
    }
  }
}

void DeploymentReader::readStartOrder() {
  for (const std::string& name : file_.texts("start_order")) {
    TaskContext* component = target_.component(name);
    if (component == nullptr) {
      file_.refuse("start_order", "there is no component " + name + "; there are " + listNames(target_.components_));
    }
    auto& order = target_.start_order_;
    if (std::find(order.begin(), order.end(), component) != order.end()) {
      file_.refuse("start_order", name + " stands there twice; remove one");
    }
    order.push_back(component);
  }
  for (const auto& component : target_.components_) {
    const auto& order = target_.start_order_;
    if (std::find(order.begin(), order.end(), component.get()) == order.end()) {
      file_.refuse("start_order", component->name() + " is missing: every component is started");
    }
  }
}

}  // namespace knee_robot::rt
