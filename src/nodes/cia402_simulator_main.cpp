// cia402_simulator --robot R --simulation S --hardware H [--bus B]: the simulated robot behind four CiA 402 drives on a
// CAN bus, as a process of its own, in real time. B is a CAN interface, or the path of a socket to which controllers
// connect as to a bus.

#include <poll.h>
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>

#include "knee_robot/base/errors.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/simulation/bus_server.h"
#include "knee_robot/simulation/can_robot.h"
#include "knee_robot/simulation/faulty_port.h"
#include "knee_robot/simulation/lost_time.h"
#include "knee_robot/simulation/truth_log.h"
#include "program.h"

namespace {

using namespace knee_robot;
using namespace knee_robot::hardware;

constexpr std::int64_t kPeriod_ns = 1'000'000;
volatile std::sig_atomic_t stop_requested = 0;

/// The bus, whichever it is, with a way to wait for its next frame.
class Bus {
 public:
  explicit Bus(const std::string& name) {
    if (name.find('/') != std::string::npos) {
      server_ = std::make_unique<simulation::BusServer>(name);
    } else {
      socket_ = can::CanSocket::open(name, {});
    }
  }
  can::FramePort& port() { return server_ ? static_cast<can::FramePort&>(*server_) : *socket_; }
  void hangUp(bool on) {
    if (server_) server_->hangUp(on);
  }
  void wait(std::int64_t deadline_ns) {
    if (server_) return server_->wait(deadline_ns);
    pollfd watched{socket_->descriptor(), POLLIN, 0};
    const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - socket_->now());
    const timespec time{left / 1'000'000'000LL, left % 1'000'000'000LL};
    ::ppoll(&watched, 1, &time, nullptr);
  }

 private:
  std::unique_ptr<simulation::BusServer> server_;
  std::unique_ptr<can::CanSocket> socket_;
};

/// The faults that inject_fault orders of drives and wire.
class OrderedFaults {
 public:
  OrderedFaults(const simulation::InjectedFaults& orders, Bus& bus, simulation::FaultyPort& wire,
                simulation::CanRobot& robot)
      : orders_(orders), bus_(bus), wire_(wire), robot_(robot) {}
  void follow() {
    wire_.set(static_cast<simulation::WireFault>(orders_.can_wire.load()));
    const bool hung_up = orders_.can_hung_up.load() != 0;
    if (hung_up != hung_up_) bus_.hangUp(hung_up);
    hung_up_ = hung_up;
    for (std::size_t i = 0; i < static_cast<std::size_t>(kAxes); ++i) {
      const auto ordered = [i](unsigned mask) { return (mask >> i & 1u) != 0; };
      simulation::DriveModel& drive = robot_.drive(i);
      drive.setSilent(ordered(orders_.can_silent.load()));
      drive.setHeartbeat(!ordered(orders_.can_no_heartbeat.load()));
      if (ordered(orders_.can_fault.load() & ~failed_)) drive.fail(0x2310);
      if (ordered(orders_.can_emergency.load() & ~warned_)) drive.warn(0x4210);
    }
    failed_ = orders_.can_fault.load();
    warned_ = orders_.can_emergency.load();
  }

 private:
  const simulation::InjectedFaults& orders_;
  Bus& bus_;
  simulation::FaultyPort& wire_;
  simulation::CanRobot& robot_;
  bool hung_up_ = false;
  unsigned failed_ = 0, warned_ = 0;
};

/// Steps the robot along the clock, answers the bus in between. Returns the milliseconds that were left out.
class Simulation {
 public:
  Simulation(Bus& bus, simulation::FaultyPort& port, simulation::CanRobot& robot, OrderedFaults faults,
             simulation::TruthLog* truth)
      : bus_(bus), port_(port), robot_(robot), faults_(faults), truth_(truth) {}

  std::int64_t run(double duration_s) {
    std::int64_t left_out = 0;
    std::int64_t next = port_.now() + kPeriod_ns;
    robot_.powerUp();
    while (stop_requested == 0 && (duration_s <= 0.0 || robot_.simulation().time() < duration_s)) {
      bus_.wait(next);
      takeFrames();
      const std::int64_t now = port_.now();
      const std::int64_t lost = simulation::lostPeriods(now - next, kPeriod_ns);
      left_out += lost;
      next += lost * kPeriod_ns;
      for (; next <= now; next += kPeriod_ns)
        step();
      robot_.stepDrives(now);
    }
    return left_out;
  }

 private:
  /// Whoever was paused finds several SYNCs: a drive would have answered each in its time, not all at once now.
  void takeFrames() {
    std::size_t count = 0, last_sync = 0;
    while (count < frames_.size() && port_.receive(frames_[count]) == can::PortStatus::Ok) {
      if (can::isSync(frames_[count])) last_sync = count;
      ++count;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (!can::isSync(frames_[i]) || i == last_sync) robot_.take(frames_[i]);
    }
  }

  void step() {
    faults_.follow();
    if (!robot_.stepPlant(1e-9 * kPeriod_ns)) {
      throw InputError("the plant's motion left all bounds; mend masses, friction or forces");
    }
    if (truth_ != nullptr) truth_->append(robot_.simulation(), static_cast<double>(port_.now()) * 1e-9);
  }

  Bus& bus_;
  simulation::FaultyPort& port_;
  simulation::CanRobot& robot_;
  OrderedFaults faults_;
  simulation::TruthLog* truth_;
  std::array<can::Frame, 256> frames_;
};

/// A real-time priority is asked for, never needed: the drives are late without it.
void askForPriority(int priority) {
  if (priority == 0) return;
  sched_param parameter{};
  parameter.sched_priority = priority;
  if (::sched_setscheduler(0, SCHED_FIFO, &parameter) != 0 || ::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    std::fprintf(stderr, "cia402_simulator: runs without real-time priority or locked memory: %s\n",
                 std::strerror(errno));
  }
}

struct Options {
  std::string robot, simulation, hardware, bus, objects, shm = "/knee_robot_sim";
  double duration_s = 0.0;
  int priority = 0;
  std::uint64_t truth_rows = 0;
};

int simulate(const Options& options) {
  const mechanism::Robot robot = mechanism::loadRobot(options.robot);
  const control::HardwareFile hardware = control::loadHardwareFile(options.hardware);
  if (!hardware.can) throw InputError(options.hardware + ": backend: must be can for drives on a CAN bus");
  const simulation::SimulationParameters parameters = simulation::loadSimulationParameters(options.simulation);
  const can::ObjectDictionary table = can::ObjectDictionary::load(options.objects);
  const dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);

  for (const int signal : {SIGINT, SIGTERM})
    std::signal(signal, [](int) { stop_requested = 1; });
  simulation::SharedImage memory = simulation::SharedImage::create(options.shm);
  Bus bus(options.bus.empty() ? hardware.can->interface : options.bus);
  simulation::FaultyPort port(bus.port());
  simulation::CanRobot drives(robot, inertia, parameters, *hardware.can, control::canUnits(robot), table,
                              memory.image(), port);
  std::optional<simulation::TruthLog> truth;
  if (options.truth_rows > 0) truth.emplace(options.shm + "_truth", options.truth_rows);
  Simulation simulation(bus, port, drives, OrderedFaults(memory.image().faults, bus, port, drives),
                        truth ? &*truth : nullptr);
  askForPriority(options.priority);
  std::printf("cia402_simulator ready: four drives on %s, robot in %s\n",
              (options.bus.empty() ? hardware.can->interface : options.bus).c_str(), options.shm.c_str());
  std::fflush(stdout);
  const std::int64_t left_out = simulation.run(options.duration_s);
  std::printf("cia402_simulator ends after %.3f s; %lld ms left out\n", drives.simulation().time(),
              static_cast<long long>(left_out));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The simulated robot behind four CiA 402 drives on a CAN bus.", "cia402_simulator");
  Options options;
  app.add_option("--robot", options.robot, "robot file (YAML)")->required();
  app.add_option("--simulation", options.simulation, "simulation file (YAML): friction, holding brakes, start")
      ->required();
  app.add_option("--hardware", options.hardware, "hardware file (YAML) with backend can: the drives that it describes")
      ->required();
  app.add_option("--objects", options.objects,
                 "table of the drives' objects (YAML), as config/hardware/can_objects.yaml")
      ->required();
  app.add_option("--bus", options.bus,
                 "CAN interface, or a path: the socket of a simulated bus; default: the hardware file's interface");
  app.add_option("--shm", options.shm, "shared memory in which the robot's state can be looked at")
      ->capture_default_str();
  app.add_option("--duration", options.duration_s, "simulated time after which it ends, s; 0: at SIGINT or SIGTERM")
      ->capture_default_str();
  app.add_option("--priority", options.priority, "SCHED_FIFO priority; 0: none")
      ->check(CLI::Range(0, 98))
      ->capture_default_str();
  app.add_option("--truth-rows", options.truth_rows,
                 "number of simulation steps to keep in shared memory NAME_truth, for fault campaigns; 0: "
                 "none")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1000000}))
      ->capture_default_str();
  app.allow_extras();  // roslaunch appends __name:= and __log:=
  return nodes::runProgram(app, argc, argv, [&] {
    for (const std::string& extra : app.remaining()) {
      if (extra.find(":=") == std::string::npos) throw InputError("unknown argument " + extra + " (see --help)");
    }
    return simulate(options);
  });
}
