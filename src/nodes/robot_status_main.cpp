// robot_status --shm NAME --duration S: what the simulated robot says about itself (the truth that no controller sees)
// and the outputs of its cards, as CSV on standard output, a row a step. For tests and fault campaigns.

#include <chrono>
#include <cstdio>
#include <thread>

#include "knee_robot/base/errors.h"
#include "knee_robot/rt/activity.h"
#include "knee_robot/simulation/shared_image.h"
#include "program.h"

namespace {

using namespace knee_robot;

void printHeader() {
  std::printf(
      "monotonic_s,time_s,length_1_m,length_2_m,length_3_m,length_4_m,Xm_m,Zm_m,theta_rad,psi_rad,voltage_1_V,"
      "voltage_2_V,voltage_3_V,voltage_4_V,digital_outputs,drives_enabled,brakes_engaged\n");
  std::fflush(stdout);
}

/// monotonic_s: CLOCK_MONOTONIC at which the row was read.
void printRow(const simulation::RobotImage& image) {
  const simulation::RobotStatus& status = image.status;
  std::printf("%.6f,%.6f", rt::toSeconds(rt::monotonicNow()), status.time_s.load());
  for (const auto* values : {&status.lengths_m, &status.pose}) {
    for (const std::atomic<double>& value : *values)
      std::printf(",%.9g", value.load());
  }
  for (const double volts : simulation::outputVolts(image.analog))
    std::printf(",%.9g", volts);
  std::printf(",%u,%u,%u\n", image.counter.outputs.load(), status.drives_enabled.load(), status.brakes_engaged.load());
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Prints the simulated robot's own state and its cards' outputs as CSV, one row per step.",
                         "robot_status");
  std::string shm = "/knee_robot_sim";
  double duration_s = 0.0;
  app.option("--shm", shm, "shared memory of the simulated robot").showDefault();
  app.option("--duration", duration_s, "duration to print, s; 0: one row").within(0.0, 3600.0).showDefault();
  return nodes::runProgram(app, argc, argv, [&] {
    simulation::SharedImage memory = simulation::SharedImage::attach(shm);
    const simulation::RobotImage& image = memory.image();
    const rt::Nanoseconds end = rt::monotonicNow() + rt::fromSeconds(duration_s);
    std::uint64_t last = image.plant_heartbeat.load();
    printHeader();
    printRow(image);
    while (rt::monotonicNow() < end) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      const std::uint64_t steps = image.plant_heartbeat.load();
      if (steps != last) printRow(image);
      last = steps;
    }
    return kExitDone;
  });
}
