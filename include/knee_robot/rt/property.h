#pragma once

#include <atomic>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/rt/task_context.h"

namespace knee_robot::rt {

/// When a property may change.
enum class Change {
  BeforeConfigure,  ///< from the deployment file only
  AtRunTime,        ///< at any time, by changeProperty(): read anew in every cycle, taken without a jump
};

/// A named parameter of a component. Values are set before configure(), some at run time too; hooks read them without
/// further ado.
class PropertyBase {
 public:
  virtual ~PropertyBase() = default;
  PropertyBase(const PropertyBase&) = delete;
  PropertyBase& operator=(const PropertyBase&) = delete;

  const std::string& name() const { return name_; }
  const std::string& unit() const { return unit_; }
  const std::string& description() const { return description_; }
  Change change() const { return change_; }
  /// "double", "int", "bool" or "string".
  virtual const char* typeName() const = 0;
  /// "0 .. 100" for numbers, else empty.
  virtual std::string rangeText() const { return ""; }
  /// As a file would have it.
  virtual std::string valueText() const = 0;
  /// Takes its value from the key of its own name. Throws InputError (file, line, value, limit).
  virtual void load(StrictMap& map) = 0;

 protected:
  PropertyBase(TaskContext& owner, std::string name, std::string unit, std::string description, Change change);

 private:
  const std::string name_, unit_, description_;
  const Change change_;
};

/// T is double, int, bool or std::string; the range holds for numbers. Numbers and flags are relaxed atomics: an
/// ordinary thread may set them while the hook reads, each by itself; what belongs together is not guaranteed to be
/// seen together.
template <typename T>
class Property;

/// A bounded real number.
template <>
class Property<double> final : public PropertyBase {
 public:
  Property(TaskContext& owner, std::string name, double value, std::string unit, double minimum, double maximum,
           std::string description, Change change = Change::BeforeConfigure)
      : PropertyBase(owner, std::move(name), std::move(unit), std::move(description), change),
        value_(value),
        minimum_(minimum),
        maximum_(maximum) {}
  operator double() const noexcept { return value(); }
  double value() const noexcept { return value_.load(std::memory_order_relaxed); }
  double minimum() const { return minimum_; }
  double maximum() const { return maximum_; }
  void set(double value) noexcept { value_.store(value, std::memory_order_relaxed); }
  const char* typeName() const override { return "double"; }
  std::string rangeText() const override { return exactNumber(minimum_) + " .. " + exactNumber(maximum_); }
  std::string valueText() const override { return exactNumber(value()); }
  void load(StrictMap& map) override { set(map.number(name(), minimum_, maximum_)); }

 private:
  std::atomic<double> value_;
  const double minimum_, maximum_;
};

/// A bounded whole number.
template <>
class Property<int> final : public PropertyBase {
 public:
  Property(TaskContext& owner, std::string name, int value, std::string unit, int minimum, int maximum,
           std::string description, Change change = Change::BeforeConfigure)
      : PropertyBase(owner, std::move(name), std::move(unit), std::move(description), change),
        value_(value),
        minimum_(minimum),
        maximum_(maximum) {}
  operator int() const noexcept { return value(); }
  int value() const noexcept { return value_.load(std::memory_order_relaxed); }
  void set(int value) noexcept { value_.store(value, std::memory_order_relaxed); }
  const char* typeName() const override { return "int"; }
  std::string rangeText() const override { return std::to_string(minimum_) + " .. " + std::to_string(maximum_); }
  std::string valueText() const override { return std::to_string(value()); }
  void load(StrictMap& map) override { set(map.integer(name(), minimum_, maximum_)); }

 private:
  std::atomic<int> value_;
  const int minimum_, maximum_;
};

/// A switch.
template <>
class Property<bool> final : public PropertyBase {
 public:
  Property(TaskContext& owner, std::string name, bool value, std::string description,
           Change change = Change::BeforeConfigure)
      : PropertyBase(owner, std::move(name), "", std::move(description), change), value_(value) {}
  operator bool() const noexcept { return value(); }
  bool value() const noexcept { return value_.load(std::memory_order_relaxed); }
  void set(bool value) noexcept { value_.store(value, std::memory_order_relaxed); }
  const char* typeName() const override { return "bool"; }
  std::string valueText() const override { return value() ? "true" : "false"; }
  void load(StrictMap& map) override { set(map.flagOr(name(), value())); }

 private:
  std::atomic<bool> value_;
};

/// Never changes at run time.
template <>
class Property<std::string> final : public PropertyBase {
 public:
  Property(TaskContext& owner, std::string name, std::string value, std::string description)
      : PropertyBase(owner, std::move(name), "", std::move(description), Change::BeforeConfigure),
        value_(std::move(value)) {}
  const std::string& value() const noexcept { return value_; }
  void set(std::string value) { value_ = std::move(value); }
  const char* typeName() const override { return "string"; }
  std::string valueText() const override { return value_; }
  void load(StrictMap& map) override { value_ = map.text(name()); }

 private:
  std::string value_;
};

/// Sets the properties of `component` from `map`, key by key. InputError: an unknown name, with the list of known ones.
void loadProperties(TaskContext& component, StrictMap& map);

/// Sets one property while the component runs, from text as a file would have it. Any ordinary thread. Throws
/// InputError when there is no such property, it may not change at run time, or the value is no number, or outside its
/// range.
void changeProperty(TaskContext& component, const std::string& property, const std::string& value);

/// One property as plain data, for the operator and for documentation.
struct PropertyReport {
  std::string component, name, type, value, unit, range, description;
  bool at_run_time = false;
};
std::vector<PropertyReport> propertiesOf(const TaskContext& component);

}  // namespace knee_robot::rt
