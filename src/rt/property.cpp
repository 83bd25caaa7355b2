#include "knee_robot/rt/property.h"

#include <algorithm>
#include <cctype>

#include "knee_robot/base/errors.h"
#include "knee_robot/rt/names.h"

namespace knee_robot::rt {
PropertyBase::PropertyBase(TaskContext& owner, std::string name, std::string unit, std::string description,
                           Change change)
    : name_(std::move(name)), unit_(std::move(unit)), description_(std::move(description)), change_(change) {
  owner.addProperty(*this);
}

void loadProperties(TaskContext& component, StrictMap& map) {
  for (const std::string& key : map.keys()) {
    PropertyBase* property = component.property(key);
    if (property == nullptr) {
      map.refuse(
          key, "component " + component.name() + " has no such property; it has " + listNames(component.properties()));
    }
    property->load(map);
  }
  map.finish();
}

void changeProperty(TaskContext& component, const std::string& name, const std::string& value) {
  PropertyBase* property = component.property(name);
  if (property == nullptr) {
    throw InputError("component " + component.name() + " has no property " + name.substr(0, 60) + "; it has " +
                     listNames(component.properties()));
  }
  if (property->change() != Change::AtRunTime) {
    throw InputError(component.name() + "." + name +
                     " may not change while the controller runs; set it in the deployment file and start anew");
  }
  // Through the same reader as the deployment file, so that both refuse the same.
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '+' || c == '-' || c == '_';
  };
  if (value.empty() || value.size() > 60 || !std::all_of(value.begin(), value.end(), plain)) {
    throw InputError(component.name() + "." + name + ": expected a plain number or word");
  }
  StrictMap map = StrictMap::parse(name + ": " + value, component.name());
  property->load(map);
}

std::vector<PropertyReport> propertiesOf(const TaskContext& component) {
  std::vector<PropertyReport> reports;
  for (const PropertyBase* one : component.properties()) {
    reports.push_back({component.name(), one->name(), one->typeName(), one->valueText(), one->unit(), one->rangeText(),
                       one->description(), one->change() == Change::AtRunTime});
  }
  return reports;
}

}  // namespace knee_robot::rt
