#include "knee_robot/rt/property.h"

namespace knee_robot::rt {

PropertyBase::PropertyBase(TaskContext& owner, std::string name, std::string unit, std::string description)
    : name_(std::move(name)), unit_(std::move(unit)), description_(std::move(description)) {
  owner.addProperty(*this);
}

void loadProperties(TaskContext& component, StrictMap& map) {
  for (const std::string& key : map.keys()) {
    PropertyBase* property = component.property(key);
    if (property == nullptr) {
      std::string known;
      for (const PropertyBase* one : component.properties())
        known += (known.empty() ? "" : ", ") + one->name();
      map.refuse(key, "component " + component.name() + " has no such property; it has " +
                          (known.empty() ? std::string("none") : known));
    }
    property->load(map);
  }
  map.finish();
}

}  // namespace knee_robot::rt
