// cia402_simulator --robot R --simulation S --hardware H [--bus B]: the simulated robot behind four CiA 402 drives on a CAN bus, as
// a process of its own, in real time. B is a CAN interface, or the path of a socket to which controllers connect as to a bus.

#include <poll.h>

#include <csignal>
#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/hardware/can/bus_server.h"
#include "knee_robot/simulation/can_robot.h"
#include "program.h"

namespace {

using namespace knee_robot;
using namespace knee_robot::hardware;

constexpr std::int64_t kPeriod_ns = 1'000'000;
/// After a pause longer than this the missed time is left out: nobody can tell what the controller would have done in it.
constexpr std::int64_t kLargestCatchUp_ns = 100 * kPeriod_ns;
volatile std::sig_atomic_t stop_requested = 0;

/// The bus, whichever it is, with a way to wait for its next frame.
class Bus {
 public:
  explicit Bus(const std::string& name) {
    if (name.find('/') != std::string::npos) {
      server_ = std::make_unique<can::BusServer>(name);
    } else {
      socket_ = can::CanSocket::open(name, {});
    }
  }
  can::FramePort& port() { return server_ ? static_cast<can::FramePort&>(*server_) : *socket_; }
  void wait(std::int64_t deadline_ns) {
    if (server_) return server_->wait(deadline_ns);
    pollfd watched{socket_->descriptor(), POLLIN, 0};
    const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - socket_->now());
    const timespec time{left / 1'000'000'000LL, left % 1'000'000'000LL};
    ::ppoll(&watched, 1, &time, nullptr);
  }

 private:
  std::unique_ptr<can::BusServer> server_;
  std::unique_ptr<can::CanSocket> socket_;
};

/// What goes wrong at a certain time: "drive_fault:2@3.5".
struct Injection {
  std::string kind;
  int axis = 0;
  double time_s = 0.0;
  bool done = false;
};

Injection parseInjection(const std::string& text) {
  Injection injection;
  char kind[32] = "";
  const bool read = std::sscanf(text.c_str(), "%31[a-z_]:%d@%lf", kind, &injection.axis, &injection.time_s) == 3;
  injection.kind = kind;
  const bool known = injection.kind == "drive_fault" || injection.kind == "emergency" || injection.kind == "silent" ||
                     injection.kind == "no_heartbeat";
  if (!read || !known || injection.axis < 1 || injection.axis > kAxes || !(injection.time_s >= 0.0)) {
    throw InputError(
        "--inject " + text +
        ": must be drive_fault, emergency, silent or no_heartbeat, then :AXIS@SECONDS, as in drive_fault:2@3.5");
  }
  return injection;
}

void inject(Injection& injection, CanRobot& robot, double time_s) {
  if (injection.done || time_s < injection.time_s) return;
  injection.done = true;
  can::DriveModel& drive = robot.drive(static_cast<std::size_t>(injection.axis - 1));
  if (injection.kind == "drive_fault") drive.fail(0x2310);
  if (injection.kind == "emergency") drive.warn(0x4210);
  if (injection.kind == "silent") drive.setSilent(true);
  if (injection.kind == "no_heartbeat") drive.setHeartbeat(false);
  std::printf("cia402_simulator: %s on axis %d\n", injection.kind.c_str(), injection.axis);
  std::fflush(stdout);
}

/// Steps the robot along the clock, answers the bus in between. Returns the milliseconds that were left out.
std::int64_t run(Bus& bus, CanRobot& robot, double duration_s, std::vector<Injection>& injections) {
  std::int64_t left_out = 0;
  can::FramePort& port = bus.port();
  std::int64_t next = port.now() + kPeriod_ns;
  robot.powerUp();
  while (stop_requested == 0 && (duration_s <= 0.0 || robot.simulation().time() < duration_s)) {
    bus.wait(next);
    can::Frame frame;
    for (int i = 0; i < 256 && port.receive(frame) == can::PortStatus::Ok; ++i)
      robot.take(frame);
    std::int64_t now = port.now();
    if (now - next > kLargestCatchUp_ns) {
      left_out += (now - next) / kPeriod_ns;
      next += (now - next) / kPeriod_ns * kPeriod_ns;
    }
    for (; next <= now; next += kPeriod_ns) {
      if (!robot.stepPlant(1e-9 * kPeriod_ns)) {
        throw InputError("the plant's motion left all bounds; mend masses, friction or forces");
      }
      for (Injection& injection : injections)
        inject(injection, robot, robot.simulation().time());
    }
    robot.stepDrives(now);
  }
  return left_out;
}

struct Options {
  std::string robot, simulation, hardware, bus, objects, shm = "/knee_robot_sim";
  double duration_s = 0.0;
  std::vector<std::string> injections;
};

int simulate(const Options& options) {
  const Robot robot = loadRobot(options.robot);
  const HardwareFile hardware = loadHardwareFile(options.hardware);
  if (!hardware.can) throw InputError(options.hardware + ": backend: must be can for drives on a CAN bus");
  const SimulationParameters parameters = loadSimulationParameters(options.simulation);
  const can::ObjectDictionary table = can::ObjectDictionary::load(options.objects);
  std::vector<Injection> injections;
  for (const std::string& text : options.injections)
    injections.push_back(parseInjection(text));
  const RobotInertia inertia = loadRobotInertia(robot);

  for (const int signal : {SIGINT, SIGTERM})
    std::signal(signal, [](int) { stop_requested = 1; });
  SharedImage memory = SharedImage::create(options.shm);
  Bus bus(options.bus.empty() ? hardware.can->interface : options.bus);
  CanRobot drives(robot, inertia, parameters, *hardware.can, canUnits(robot), table, memory.image(), bus.port());
  std::printf("cia402_simulator ready: four drives on %s, robot in %s\n",
              (options.bus.empty() ? hardware.can->interface : options.bus).c_str(), options.shm.c_str());
  std::fflush(stdout);
  const std::int64_t left_out = run(bus, drives, options.duration_s, injections);
  std::printf("cia402_simulator ends after %.3f s; %lld ms left out\n", drives.simulation().time(),
              static_cast<long long>(left_out));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The simulated robot behind four CiA 402 drives on a CAN bus.", "cia402_simulator");
  Options options;
  app.add_option("--robot", options.robot, "robot file (YAML)")->required();
  app.add_option("--simulation", options.simulation, "simulation file (YAML): friction, hold devices, start")
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
  app.add_option("--duration", options.duration_s, "simulated seconds until it ends; 0: until SIGINT or SIGTERM")
      ->capture_default_str();
  app.add_option("--inject", options.injections,
                 "fault: KIND:AXIS@SECONDS; drive_fault, emergency, silent, no_heartbeat");
  app.allow_extras();  // roslaunch appends __name:= and __log:=
  return runProgram(app, argc, argv, [&] {
    for (const std::string& extra : app.remaining()) {
      if (extra.find(":=") == std::string::npos) throw InputError("unknown argument " + extra + " (see --help)");
    }
    return simulate(options);
  });
}
