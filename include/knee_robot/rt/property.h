#pragma once

#include <limits>
#include <string>
#include <utility>

#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/rt/task_context.h"

namespace knee_robot::rt {

/// A named parameter of a component. Values are set before configure(); hooks read them without further ado.
class PropertyBase {
 public:
  virtual ~PropertyBase() = default;
  PropertyBase(const PropertyBase&) = delete;
  PropertyBase& operator=(const PropertyBase&) = delete;

  const std::string& name() const { return name_; }
  const std::string& unit() const { return unit_; }
  const std::string& description() const { return description_; }
  /// Takes its value from the key of its own name. Throws InputError (file, line, value, limit).
  virtual void load(StrictMap& map) = 0;

 protected:
  PropertyBase(TaskContext& owner, std::string name, std::string unit, std::string description);

 private:
  const std::string name_, unit_, description_;
};

/// T is double, int, bool or std::string; the range holds for numbers.
template <typename T>
class Property;

/// A bounded real number.
template <>
class Property<double> final : public PropertyBase {
 public:
  Property(TaskContext& owner, std::string name, double value, std::string unit, double minimum, double maximum,
           std::string description)
      : PropertyBase(owner, std::move(name), std::move(unit), std::move(description)),
        value_(value),
        minimum_(minimum),
        maximum_(maximum) {}
  operator double() const noexcept { return value_; }
  double value() const noexcept { return value_; }
  double minimum() const { return minimum_; }
  double maximum() const { return maximum_; }
  void set(double value) { value_ = value; }
  void load(StrictMap& map) override { value_ = map.number(name(), minimum_, maximum_); }

 private:
  double value_;
  const double minimum_, maximum_;
};

/// A bounded whole number.
template <>
class Property<int> final : public PropertyBase {
 public:
  Property(TaskContext& owner, std::string name, int value, std::string unit, int minimum, int maximum,
           std::string description)
      : PropertyBase(owner, std::move(name), std::move(unit), std::move(description)),
        value_(value),
        minimum_(minimum),
        maximum_(maximum) {}
  operator int() const noexcept { return value_; }
  int value() const noexcept { return value_; }
  void set(int value) { value_ = value; }
  void load(StrictMap& map) override { value_ = map.integer(name(), minimum_, maximum_); }

 private:
  int value_;
  const int minimum_, maximum_;
};

template <>
class Property<bool> final : public PropertyBase {
 public:
  Property(TaskContext& owner, std::string name, bool value, std::string description)
      : PropertyBase(owner, std::move(name), "", std::move(description)), value_(value) {}
  operator bool() const noexcept { return value_; }
  bool value() const noexcept { return value_; }
  void set(bool value) { value_ = value; }
  void load(StrictMap& map) override { value_ = map.flagOr(name(), value_); }

 private:
  bool value_;
};

template <>
class Property<std::string> final : public PropertyBase {
 public:
  Property(TaskContext& owner, std::string name, std::string value, std::string description)
      : PropertyBase(owner, std::move(name), "", std::move(description)), value_(std::move(value)) {}
  const std::string& value() const noexcept { return value_; }
  void set(std::string value) { value_ = std::move(value); }
  void load(StrictMap& map) override { value_ = map.text(name()); }

 private:
  std::string value_;
};

/// Sets the properties of `component` from `map`, key by key. An unknown name is refused with the list of known ones.
void loadProperties(TaskContext& component, StrictMap& map);

}  // namespace knee_robot::rt
