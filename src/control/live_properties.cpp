#include "live_properties.h"

#include <cmath>
#include <cstdlib>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::control {
namespace {

constexpr double kLargestChange = 0.2;         // of a property's value when the patient was loaded
constexpr double kLargestPayloadChange = 2.0;  // kg

}  // namespace

std::string whyTooFar(const rt::PropertyReport& was, const std::string& value) {
  char* end = nullptr;
  const double before = std::strtod(was.value.c_str(), &end);
  if (end == was.value.c_str()) return "";
  const double largest =
      was.unit == "kg" ? kLargestPayloadChange : kLargestChange * (before != 0.0 ? std::abs(before) : 1.0);
  const double change = std::abs(std::strtod(value.c_str(), nullptr) - before);
  if (change <= largest) return "";
  return was.component + "." + was.name + " was " + was.value + " when the patient was loaded and may be changed by " +
         shortNumber(largest) + " " + was.unit + " at most while the patient is on the robot";
}

std::vector<rt::PropertyReport> LiveProperties::all() const {
  std::vector<rt::PropertyReport> all;
  for (const auto& component : deployment_.components()) {
    for (rt::PropertyReport& one : rt::propertiesOf(*component))
      all.push_back(std::move(one));
  }
  return all;
}

std::string LiveProperties::whyNotAsDeployed() const {
  std::string others;
  const std::vector<rt::PropertyReport> now = all();
  for (std::size_t i = 0; i < now.size() && i < deployed_.size(); ++i) {
    if (!now[i].at_run_time || now[i].unit == "kg" || control::whyTooFar(deployed_[i], now[i].value).empty()) continue;
    others += (others.empty() ? "" : ", ") + now[i].component + "." + now[i].name + " is " + now[i].value +
              " and was " + deployed_[i].value + " when the controller started";
  }
  if (others.empty()) return "";
  return others + ": set it back, or start the controller anew, before somebody is on the robot";
}

void LiveProperties::bind() {
  std::vector<rt::PropertyReport> now = all();
  const std::lock_guard<std::mutex> lock(mutex_);
  bound_ = std::move(now);
}

void LiveProperties::unbind() {
  const std::lock_guard<std::mutex> lock(mutex_);
  bound_.clear();
}

void LiveProperties::forgetPayloads() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (bound_.empty()) return;
  }
  const std::lock_guard<std::mutex> one_at_a_time(setting_);
  for (const rt::PropertyReport& one : deployed_) {
    if (one.at_run_time && one.unit == "kg")
      rt::changeProperty(*deployment_.component(one.component), one.name, one.value);
  }
}

/// In however many steps.
std::string LiveProperties::whyTooFar(const std::string& component, const std::string& property,
                                      const std::string& value) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const rt::PropertyReport& one : bound_) {
    if (one.component == component && one.name == property) return control::whyTooFar(one, value);
  }
  return "";
}

Answer LiveProperties::set(const std::string& component, const std::string& property, const std::string& value) {
  rt::TaskContext* found = deployment_.component(component);
  if (found == nullptr)
    return {false, "there is no component " + component.substr(0, 60) + "; list_components names them"};
  if (const std::string why = whyTooFar(component, property, value); !why.empty()) return {false, why};
  const std::lock_guard<std::mutex> one_at_a_time(setting_);
  if (const auto* driver = dynamic_cast<const Driver*>(found)) {
    const double wanted = std::strtod(value.c_str(), nullptr);
    std::string why = feedforward_.whyNotPassive(*driver, property, wanted);
    if (why.empty()) why = feedforward_.whyUnstable(*driver, property, wanted);
    if (!why.empty()) return {false, why};
  }
  try {
    const rt::PropertyBase* changed = found->property(property);
    const std::string before = changed == nullptr ? "" : changed->valueText();
    rt::changeProperty(*found, property, value);
    return {true, component + "." + property + " is " + changed->valueText() + " " + changed->unit() + " (was " +
                      before + ")"};
  } catch (const InputError& error) {
    return {false, error.what()};
  }
}

}  // namespace knee_robot::control
