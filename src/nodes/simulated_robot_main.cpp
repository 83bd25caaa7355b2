// simulated_robot --robot R --simulation S --shm NAME: the robot as a process of its own, in real time, behind the
// registers of its two cards in shared memory. A controller may die, hang and come back: this goes on, as a machine
// does.

#include <time.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/lost_time.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/truth_log.h"
#include "program.h"
#include "simulator.h"

namespace {

using namespace knee_robot;

constexpr std::int64_t kPeriod_ns = 1000000;

/// roslaunch ends all at once: the machine stays until the controller has brought it down, as a machine does. A second
/// signal ends it at once.
constexpr double kLongestFarewell_s = 10.0, kAfterDrivesOff_s = 0.5;

std::atomic<int> stops_requested{0};

void requestStop(int /*signal*/) {
  stops_requested.fetch_add(1);
}

/// Whether the robot may go now.
class Farewell {
 public:
  bool isOver(const simulation::RobotImage& image, double time_s) {
    const int requests = stops_requested.load();
    if (requests == 0) return false;
    if (since_s_ < 0.0) since_s_ = off_since_s_ = time_s;
    if (image.status.drives_enabled.load() != 0) off_since_s_ = time_s;
    return requests > 1 || time_s - since_s_ > kLongestFarewell_s || time_s - off_since_s_ > kAfterDrivesOff_s;
  }

 private:
  double since_s_ = -1.0, off_since_s_ = 0.0;
};

std::int64_t now() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * 1000000000LL + time.tv_nsec;
}

void sleepUntil(std::int64_t deadline) {
  const timespec time{deadline / 1000000000LL, deadline % 1000000000LL};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time,
                    nullptr);  // a signal wakes it early: the caller looks at the clock
}

/// Steps the robot along the clock; returns the milliseconds that were left out.
std::int64_t run(simulation::RobotSimulation& simulation, const simulation::RobotImage& image, double duration_s,
                 simulation::TruthLog* truth) {
  const double dt = static_cast<double>(kPeriod_ns) * 1e-9;
  std::int64_t left_out = 0;
  std::int64_t next = now();
  Farewell farewell;
  while (!farewell.isOver(image, simulation.time()) && (duration_s <= 0.0 || simulation.time() < duration_s)) {
    next += kPeriod_ns;
    sleepUntil(next);
    const std::int64_t lost = simulation::lostPeriods(now() - next, kPeriod_ns);
    left_out += lost;
    next += lost * kPeriod_ns;
    if (!simulation.step(dt)) throw InputError("the plant's motion left all bounds; mend masses, friction or forces");
    if (truth != nullptr) truth->append(simulation, static_cast<double>(now()) * 1e-9);
  }
  return left_out;
}

int simulate(const nodes::SimulatorOptions& options) {
  const mechanism::Robot robot = mechanism::loadRobot(options.robot);
  const simulation::SimulationParameters parameters = simulation::loadSimulationParameters(options.simulation);
  const dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);
  // Checked on the heap first, so that a bad file leaves no shared memory behind for even a moment.
  auto rehearsal = std::make_unique<simulation::RobotImage>();
  simulation::RobotSimulation(robot, inertia, parameters, *rehearsal);

  std::signal(SIGINT, requestStop);
  std::signal(SIGTERM, requestStop);
  simulation::SharedImage memory = simulation::SharedImage::create(options.shm);
  simulation::RobotSimulation simulation(robot, inertia, parameters, memory.image());
  std::optional<simulation::TruthLog> truth;
  if (options.truth_rows > 0) truth.emplace(options.shm + "_truth", options.truth_rows);
  nodes::askForRealTime("simulated_robot", options);
  const mechanism::Lengths start = simulation.lengths();
  std::printf("simulated_robot ready: %s, lengths %.4f %.4f %.4f %.4f m\n", options.shm.c_str(), start[0], start[1],
              start[2], start[3]);
  std::fflush(stdout);
  const std::int64_t left_out = run(simulation, memory.image(), options.duration_s, truth ? &*truth : nullptr);
  // For whoever is still attached, the cards are gone from here on.
  memory.image().analog.disconnected.store(1);
  memory.image().counter.disconnected.store(1);
  std::printf("simulated_robot ends after %.3f s; %lld ms left out\n", simulation.time(),
              static_cast<long long>(left_out));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Simulates the robot in real time; its cards are register models in shared memory.",
                         "simulated_robot");
  app.serves();
  nodes::SimulatorOptions options;
  nodes::declareSimulator(app, "name of the shared memory", options);
  return nodes::runProgram(app, argc, argv, [&] { return simulate(options); });
}
