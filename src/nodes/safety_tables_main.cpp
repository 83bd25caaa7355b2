// safety_tables: the controller's own tables of faults, resets and requests, as Markdown (docs/safety.md holds a copy).

#include <cstdio>

#include "knee_robot/control/safety_tables.h"
#include "program.h"

int main(int argc, char** argv) {
  knee_robot::nodes::CommandLine app("Prints the controller's tables of faults and of requests, as Markdown.",
                                     "safety_tables");
  bool faults = false, requests = false;
  app.flag("--faults", faults, "only the faults");
  app.flag("--requests", requests, "only the requests");
  return knee_robot::nodes::runProgram(app, argc, argv, [&] {
    if (!requests) std::printf("%s\n", knee_robot::control::faultsTable().c_str());
    if (!faults) std::printf("%s", knee_robot::control::requestsTable().c_str());
    return 0;
  });
}
