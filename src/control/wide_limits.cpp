#include "wide_limits.h"

#include <limits>
#include <optional>

#include "knee_robot/base/numbers.h"

namespace knee_robot::control {
namespace {

struct Bound {
  const char* property;
  double least, most;
};

constexpr double kNone = std::numeric_limits<double>::infinity();

// About twice to three times the defaults, or a third of them where less is wider; a patient's own limits less.
constexpr Bound kMonitors[] = {
    {"patient_margin_m", 0.0, 0.005},
    {"patient_margin_rad", 0.0, 0.02},
    {"patient_speed_factor", 0.0, 1.5},
    {"patient_force_s", 0.0, 0.2},
    {"velocity_factor", 0.0, 2.0},
    {"velocity_floor_m_per_s", 0.0, 0.06},
    {"velocity_s", 0.0, 0.02},
    {"soft_margin_m", 0.0, 0.002},
    {"soft_speed_m_per_s", 0.0, 0.006},
    {"stall_s", 0.0, 1.0},
    {"stall_share", 0.0, 0.9},
    {"stall_error_m", 0.0, 0.003},
    {"stall_speed_m_per_s", 3e-4, kNone},
    {"saturation_s", 0.0, 0.75},
    {"runaway_error_m", 0.0, 0.003},
    {"release_error_m", 0.0, 0.012},
    {"release_s", 0.0, 0.9},
    {"runaway_speed_m_per_s", 0.0, 0.09},
    {"runaway_s", 0.0, 0.02},
    {"runaway_acceleration_m_per_s2", 0.0, 1.5},
    {"runaway_force_share", 0.0, 0.3},
    {"frozen_distance_m", 0.0, 0.006},
    {"frozen_force_N", 0.0, 600.0},
    {"frozen_share", 0.0, 0.7},
    {"jump_factor", 0.0, 12.0},
    {"jump_floor_m", 0.0, 0.003},
    {"jump_gap_m", 0.0, 0.015},
    {"jump_acceleration_m_per_s2", 0.0, 600.0},
    {"thermal_time_constant_s", 0.0, 120.0},
    {"thermal_housing_s", 0.0, 3300.0},
    {"thermal_winding_share", 0.1, kNone},
};
constexpr Bound kDriver[] = {
    {"following_error_m", 0.0, 0.02}, {"following_error_s", 0.0, 0.25}, {"standing_force_N", 0.0, 20.0},
    {"turning_force_N", 0.0, 60.0},   {"probe_share", 0.2, kNone},      {"stale_set_points", 0.0, 9.0},
    {"missing_set_points", 0.0, 2.0}, {"stale_measurements", 0.0, 9.0},
};
constexpr Bound kSync[] = {
    {"start_tolerance_m", 0.0, 0.005},
    {"stop_time_s", 0.0, 0.9},
    {"orders_timeout_s", 0.0, 0.15},
};
constexpr Bound kSupervisor[] = {
    {"brake_test_N", 60.0, kNone},
    {"brake_slip_m", 0.0, 0.002},
    {"range_margin_m", 0.0, 0.01},
    {"stale_measurements", 0.0, 9.0},
};
constexpr Bound kOutput[] = {
    {"transfer_s", 0.04, kNone},      {"slip_m", 0.0, 0.002},          {"decelerate_limit_s", 0.0, 2.0},
    {"command_timeout_s", 0.0, 0.01}, {"orders_timeout_s", 0.0, 0.01},
};
constexpr Bound kObserver[] = {{"rest_question_s", 1.0, 90.0}};
constexpr Bound kGuide[] = {
    {"share_friction", 0.0, 0.8},
    {"unknown_load_N", 0.0, 360.0},
    {"wall_N", 40.0, kNone},
    {"weigh_s", 0.3, kNone},
};

std::optional<double> numberOf(const rt::PropertyBase* property) {
  if (const auto* real = dynamic_cast<const rt::Property<double>*>(property)) return real->value();
  if (const auto* whole = dynamic_cast<const rt::Property<int>*>(property)) return whole->value();
  return std::nullopt;
}

/// A property that went by another name would not be judged by anybody: it counts as open.
template <std::size_t N>
void add(std::vector<std::string>& open, const rt::TaskContext* component, const Bound (&bounds)[N]) {
  if (component == nullptr) return;
  for (const Bound& bound : bounds) {
    const std::optional<double> value = numberOf(component->property(bound.property));
    if (value && *value >= bound.least && *value <= bound.most) continue;
    const std::string name = component->name() + "." + bound.property;
    if (!value) {
      open.push_back(name + " (is not there)");
      continue;
    }
    open.push_back(
        name + " " + shortNumber(*value) +
        (*value < bound.least ? " (at least " + shortNumber(bound.least) : " (at most " + shortNumber(bound.most)) +
        ")");
  }
}

template <std::size_t N>
void list(std::vector<WideLimit>& all, const char* type, const Bound (&bounds)[N]) {
  for (const Bound& bound : bounds)
    all.push_back({type, bound.property, bound.least, bound.most});
}

}  // namespace

std::vector<WideLimit> wideLimits() {
  std::vector<WideLimit> all;
  list(all, "Monitors", kMonitors);
  list(all, "Driver", kDriver);
  list(all, "Sync", kSync);
  list(all, "Supervisor", kSupervisor);
  list(all, "AxesOutput", kOutput);
  list(all, "DisturbanceObserver", kObserver);
  list(all, "HandGuide", kGuide);
  return all;
}

std::vector<std::string> limitsOpenedWide(const MachineComponents& machine) {
  std::vector<std::string> open;
  add(open, machine.monitors, kMonitors);
  for (const Driver* driver : machine.drivers)
    add(open, driver, kDriver);
  add(open, machine.sync, kSync);
  add(open, machine.supervisor, kSupervisor);
  add(open, machine.output, kOutput);
  add(open, machine.observer, kObserver);
  add(open, machine.guide, kGuide);
  return open;
}

}  // namespace knee_robot::control
