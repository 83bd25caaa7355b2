#include "controller_components.h"

#include "knee_robot/rt/operation.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"
#include "terminal.h"

namespace knee_robot::nodes {
namespace {

Component componentMessage(const rt::TaskContext& component) {
  Component message;
  message.name = component.name();
  message.state = rt::toString(component.state());
  for (const rt::PortBase* port : component.ports()) {
    ComponentPort one;
    one.name = port->name();
    one.type = port->typeName();
    one.description = port->description();
    one.output = port->isOutput();
    one.connected = port->isConnected();
    message.ports.push_back(one);
  }
  for (const rt::PropertyReport& property : rt::propertiesOf(component)) {
    ComponentProperty one;
    one.name = property.name;
    one.type = property.type;
    one.value = property.value;
    one.unit = property.unit;
    one.range = property.range;
    one.description = property.description;
    one.at_run_time = property.at_run_time;
    message.properties.push_back(one);
  }
  for (const rt::OperationBase* operation : component.operations())
    message.operations.push_back(operation->signature());
  return message;
}

}  // namespace

ControllerComponents::ControllerComponents(ros::NodeHandle& node, control::ControlSystem& system, EventLog& log)
    : system_(system),
      log_(log),
      list_(node.advertiseService("list_components", &ControllerComponents::list, this)),
      set_(node.advertiseService("set_property", &ControllerComponents::set, this)) {}

bool ControllerComponents::list(ListComponents::Request& request, ListComponents::Response& response) {
  for (const auto& component : system_.deployment().components()) {
    if (request.component.empty() || component->name() == request.component)
      response.components.push_back(componentMessage(*component));
  }
  response.success = !response.components.empty();
  if (!response.success)
    response.message = "there is no component " + request.component.substr(0, 60) + "; an empty name lists all";
  return true;
}

bool ControllerComponents::set(ros::ServiceEvent<SetProperty::Request, SetProperty::Response>& call) {
  const SetProperty::Request& request = call.getRequest();
  SetProperty::Response& response = call.getResponse();
  const control::Answer answer = system_.setProperty(request.component, request.property, request.value);
  response.success = answer.ok;
  response.message = answer.sentence;
  log_.request(call.getCallerName(), "set_property " + request.component + "." + request.property + " " + request.value,
               answer);
  showAnswer("set_property", answer);
  return true;
}

}  // namespace knee_robot::nodes
