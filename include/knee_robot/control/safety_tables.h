#pragma once

#include <string>

namespace knee_robot::control {

/// Markdown tables from the code's own tables, for docs/safety.md and for the operator. Not real-time.
std::string faultsTable();    ///< number, name, cause, how it stops (IEC 60204-1), what to do, when it can be reset
std::string requestsTable();  ///< which request is possible in which state

}  // namespace knee_robot::control
