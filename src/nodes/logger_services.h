#pragma once

namespace knee_robot::nodes {

/// Takes back roscpp's service get_loggers (rqt_logger_level calls it). With Debian 12's rosconsole and log4cxx its
/// answer destroys the repository of all loggers, and whatever logs from a new place after it ends the process by
/// signal 11. After the first NodeHandle, which offers it.
void withdrawLoggerList();

}  // namespace knee_robot::nodes
