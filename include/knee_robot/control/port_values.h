#pragma once

#include <cstddef>
#include <string>
#include <typeindex>
#include <vector>

namespace knee_robot::control {

/// What travels through the ports as plain numbers, for plots: the structures of axis_data.h and machine_state.h,
/// member by member.
/// Arrays per actuator count from 1 ("force_N_1"), poses and wrenches are named by coordinate ("push_Zm"), what holds
/// structures by a dot ("bus_failure.code"). Enumerations, flags and counters are numbers, times in ns. Not real-time.

/// The names of a type's numbers; empty: a type that is not known here.
std::vector<std::string> portValueNames(std::type_index type);

/// The numbers of one value of a known type, in the order of the names.
void portValues(std::type_index type, const void* value, std::vector<double>& numbers);

/// Bytes of the type, and those that its described members take: so that a test finds a member that is missing.
struct PortTypeLayout {
  /// Where a described member lies in the type, bytes.
  struct Member {
    std::size_t begin, end, alignment;
  };
  std::string type;
  std::size_t size = 0;
  std::vector<Member> members;
};
PortTypeLayout portTypeLayout(std::type_index type);

/// All known types with their names as a Markdown table.
std::string portValuesTable();

}  // namespace knee_robot::control
