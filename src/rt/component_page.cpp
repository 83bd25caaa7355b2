#include "knee_robot/rt/component_page.h"

#include "knee_robot/rt/operation.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::rt {
namespace {

std::string withoutNamespace(std::string text) {
  const std::string prefix = "knee_robot::";
  for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
    text.erase(at, prefix.size());
  return text;
}

std::string portTable(const TaskContext& component) {
  std::string text = "\n| port | carries | |\n| --- | --- | --- |\n";
  for (const PortBase* port : component.ports()) {
    const std::string direction = port->isOutput() ? "out: " : port->isRequired() ? "in: " : "in, optional: ";
    text += "| `" + port->name() + "` | `" + withoutNamespace(port->typeName()) + "` | " + direction +
            port->description() + " |\n";
  }
  return component.ports().empty() ? "" : text;
}

std::string propertyTable(const TaskContext& component) {
  std::string text = "\n| property | default | range | |\n| --- | --- | --- | --- |\n";
  for (const PropertyBase* one : component.properties()) {
    const std::string unit = one->unit().empty() ? "" : " " + one->unit();
    const std::string when = one->change() == Change::AtRunTime ? " (at run time, too)" : "";
    text += "| `" + one->name() + "` | " + one->valueText() + unit + " | " + one->rangeText() + " | " +
            one->description() + when + " |\n";
  }
  return component.properties().empty() ? "" : text;
}

std::string operationTable(const TaskContext& component) {
  std::string text = "\n| operation | |\n| --- | --- |\n";
  for (const OperationBase* one : component.operations())
    text += "| `" + withoutNamespace(one->signature()) + "` | " + one->description() + " |\n";
  return component.operations().empty() ? "" : text;
}

}  // namespace

std::string componentPage(const TypeFactory& types) {
  std::string text;
  for (const auto& [type, make] : types) {
    const std::unique_ptr<TaskContext> component = make(type);
    text += "## " + type + "\n" + portTable(*component) + propertyTable(*component) + operationTable(*component) + "\n";
  }
  return text;
}

}  // namespace knee_robot::rt
