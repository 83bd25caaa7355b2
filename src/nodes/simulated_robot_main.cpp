// simulated_robot --robot R --simulation S --shm NAME: the robot as a process of its own, in real time, behind the
// registers of its two cards in shared memory. A controller may die, hang and come back: this goes on, as a machine
// does.

#include <sys/mman.h>
#include <time.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/lost_time.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/truth_log.h"
#include "program.h"

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

/// A real-time priority is asked for, never needed: the robot is late without it, and says so.
void askForPriority(int priority) {
  if (priority == 0) return;
  sched_param parameter{};
  parameter.sched_priority = priority;
  if (::sched_setscheduler(0, SCHED_FIFO, &parameter) != 0) {
    std::fprintf(stderr, "simulated_robot: runs without real-time priority: %s\n", std::strerror(errno));
  }
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    std::fprintf(stderr, "simulated_robot: memory is not locked: %s\n", std::strerror(errno));
  }
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

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulates the robot in real time; its cards are register models in shared memory.", "simulated_robot");
  std::string robot_file, simulation_file, shm = "/knee_robot_sim";
  double duration_s = 0.0;
  int priority = 0;
  std::uint64_t truth_rows = 0;
  app.add_option("--robot", robot_file, "robot file (YAML)")->required();
  app.add_option("--simulation", simulation_file, "simulation file (YAML): friction, holding brakes, start")
      ->required();
  app.add_option("--shm", shm, "name of the shared memory")->capture_default_str();
  app.add_option("--duration", duration_s, "simulated time after which it ends, s; 0: at SIGINT or SIGTERM")
      ->capture_default_str();
  app.add_option("--priority", priority, "SCHED_FIFO priority; 0: none")
      ->check(CLI::Range(0, 98))
      ->capture_default_str();
  app.add_option("--truth-rows", truth_rows,
                 "number of simulation steps to keep in shared memory NAME_truth, for fault campaigns; 0: "
                 "none")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1000000}))
      ->capture_default_str();
  app.allow_extras();  // roslaunch appends __name:= and __log:=
  return nodes::runProgram(app, argc, argv, [&] {
    for (const std::string& extra : app.remaining()) {
      if (extra.find(":=") == std::string::npos) throw InputError("unknown argument " + extra + " (see --help)");
    }
    const mechanism::Robot robot = mechanism::loadRobot(robot_file);
    const simulation::SimulationParameters parameters = simulation::loadSimulationParameters(simulation_file);
    const dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);
    // Checked on the heap first, so that a bad file leaves no shared memory behind for even a moment.
    auto rehearsal = std::make_unique<simulation::RobotImage>();
    simulation::RobotSimulation(robot, inertia, parameters, *rehearsal);

    std::signal(SIGINT, requestStop);
    std::signal(SIGTERM, requestStop);
    simulation::SharedImage memory = simulation::SharedImage::create(shm);
    simulation::RobotSimulation simulation(robot, inertia, parameters, memory.image());
    std::optional<simulation::TruthLog> truth;
    if (truth_rows > 0) truth.emplace(shm + "_truth", truth_rows);
    askForPriority(priority);
    const mechanism::Lengths start = simulation.lengths();
    std::printf("simulated_robot ready: %s, lengths %.4f %.4f %.4f %.4f m\n", shm.c_str(), start[0], start[1], start[2],
                start[3]);
    std::fflush(stdout);
    const std::int64_t left_out = run(simulation, memory.image(), duration_s, truth ? &*truth : nullptr);
    // For whoever is still attached, the cards are gone from here on.
    memory.image().analog.disconnected.store(1);
    memory.image().counter.disconnected.store(1);
    std::printf("simulated_robot ends after %.3f s; %lld ms left out\n", simulation.time(),
                static_cast<long long>(left_out));
    return kExitDone;
  });
}
