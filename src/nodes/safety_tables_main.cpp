// safety_tables: what the controller's own tables say about faults, resets and requests, as Markdown (docs/safety.md
// holds a copy).

#include <CLI/CLI.hpp>
#include <cstdio>

#include "knee_robot/control/safety_tables.h"

int main(int argc, char** argv) {
  CLI::App app("Prints the tables of faults and of requests as the controller has them.");
  bool faults = false, requests = false;
  app.add_flag("--faults", faults, "only the faults");
  app.add_flag("--requests", requests, "only the requests");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "safety_tables: %s\n", error.what());
    return 2;
  }
  if (!requests) std::printf("%s\n", knee_robot::control::faultsTable().c_str());
  if (!faults) std::printf("%s", knee_robot::control::requestsTable().c_str());
  return 0;
}
