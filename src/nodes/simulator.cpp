#include "simulator.h"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace knee_robot::nodes {

void declareSimulator(CommandLine& app, const std::string& shm, SimulatorOptions& options) {
  app.option("--robot", options.robot, "robot file (YAML)").required();
  app.option("--simulation", options.simulation, "simulation file (YAML): friction, holding brakes, start").required();
  app.option("--shm", options.shm, shm).showDefault();
  app.option("--duration", options.duration_s, "simulated time after which it ends, s; 0: at SIGINT or SIGTERM")
      .showDefault();
  app.option("--priority", options.priority, "SCHED_FIFO priority; 0: none").within(0, 98).showDefault();
  app.option("--cpu", options.cpu, "processor to run on; -1: any").within(-1, 1023).showDefault();
  app.option("--truth-rows", options.truth_rows,
             "number of simulation steps to keep in shared memory NAME_truth, for fault campaigns; 0: "
             "none")
      .within(std::uint64_t{0}, std::uint64_t{1000000})
      .showDefault();
  app.allowExtras();  // roslaunch appends __name:= and __log:=
}

void askForRealTime(const std::string& program, const SimulatorOptions& options) {
  if (options.cpu >= 0) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    CPU_SET(static_cast<unsigned>(options.cpu), &cpus);
    if (::sched_setaffinity(0, sizeof cpus, &cpus) != 0)
      std::fprintf(stderr, "%s: not bound to processor %d: %s\n", program.c_str(), options.cpu, std::strerror(errno));
  }
  if (options.priority == 0) return;
  sched_param parameter{};
  parameter.sched_priority = options.priority;
  if (::sched_setscheduler(0, SCHED_FIFO, &parameter) != 0)
    std::fprintf(stderr, "%s: runs without real-time priority: %s\n", program.c_str(), std::strerror(errno));
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    std::fprintf(stderr, "%s: memory is not locked: %s\n", program.c_str(), std::strerror(errno));
}

}  // namespace knee_robot::nodes
