#include "wide_limits.h"

#include <limits>

#include "knee_robot/base/numbers.h"

namespace knee_robot::control {
namespace {

struct Bound {
  const char* property;
  double least, most;
};

constexpr double kNone = std::numeric_limits<double>::infinity();

// About twice to three times the defaults; a patient's own limits less.
constexpr Bound kMonitors[] = {
    {"patient_margin_m", 0.0, 0.005},     {"patient_margin_rad", 0.0, 0.02},
    {"patient_speed_factor", 0.0, 1.5},   {"patient_force_s", 0.0, 0.2},
    {"velocity_factor", 0.0, 2.0},        {"velocity_s", 0.0, 0.02},
    {"soft_margin_m", 0.0, 0.002},        {"stall_s", 0.0, 1.0},
    {"saturation_s", 0.0, 0.75},          {"runaway_error_m", 0.0, 0.003},
    {"release_error_m", 0.0, 0.012},      {"release_s", 0.0, 0.9},
    {"runaway_speed_m_per_s", 0.0, 0.09}, {"runaway_s", 0.0, 0.02},
    {"frozen_distance_m", 0.0, 0.006},    {"frozen_force_N", 0.0, 600.0},
    {"jump_factor", 0.0, 12.0},           {"jump_floor_m", 0.0, 0.003},
    {"jump_gap_m", 0.0, 0.015},
};
constexpr Bound kDriver[] = {
    {"following_error_m", 0.0, 0.02},
    {"following_error_s", 0.0, 0.25},
    {"standing_force_N", 0.0, 20.0},
    {"turning_force_N", 0.0, 60.0},
};
constexpr Bound kSupervisor[] = {
    {"brake_test_N", 60.0, kNone},
    {"brake_slip_m", 0.0, 0.002},
    {"range_margin_m", 0.0, 0.01},
};
constexpr Bound kOutput[] = {
    {"transfer_s", 0.04, kNone},      {"slip_m", 0.0, 0.002},          {"decelerate_limit_s", 0.0, 2.0},
    {"command_timeout_s", 0.0, 0.01}, {"orders_timeout_s", 0.0, 0.01},
};

template <std::size_t N>
void add(std::vector<std::string>& open, const rt::TaskContext& component, const Bound (&bounds)[N]) {
  for (const Bound& bound : bounds) {
    const auto* property = dynamic_cast<const rt::Property<double>*>(component.property(bound.property));
    if (property == nullptr) continue;
    const double value = property->value();
    if (value >= bound.least && value <= bound.most) continue;
    open.push_back(
        component.name() + "." + bound.property + " " + shortNumber(value) +
        (value < bound.least ? " (at least " + shortNumber(bound.least) : " (at most " + shortNumber(bound.most)) +
        ")");
  }
}

}  // namespace

std::vector<std::string> limitsOpenedWide(const MachineComponents& machine) {
  std::vector<std::string> open;
  add(open, *machine.monitors, kMonitors);
  for (const Driver* driver : machine.drivers)
    add(open, *driver, kDriver);
  add(open, *machine.supervisor, kSupervisor);
  add(open, *machine.output, kOutput);
  return open;
}

}  // namespace knee_robot::control
