// cia402_simulator --robot R --simulation S --hardware H [--bus B]: the simulated robot behind four CiA 402 drives on a
// CAN bus, as a process of its own, in real time. B is a CAN interface, or the path of a socket to which controllers
// connect as to a bus.

#include <poll.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <optional>

#include "knee_robot/base/errors.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/simulation/bus_server.h"
#include "knee_robot/simulation/can_robot.h"
#include "knee_robot/simulation/faulty_port.h"
#include "knee_robot/simulation/lost_time.h"
#include "knee_robot/simulation/truth_log.h"
#include "program.h"
#include "simulator.h"

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

struct Options : nodes::SimulatorOptions {
  std::string hardware, bus, objects;
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
  nodes::askForRealTime("cia402_simulator", options);
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
  nodes::CommandLine app("The simulated robot behind four CiA 402 drives on a CAN bus.", "cia402_simulator");
  app.serves();
  Options options;
  nodes::declareSimulator(app, "shared memory in which the robot's state can be looked at", options);
  app.option("--hardware", options.hardware, "hardware file (YAML) with backend can: the drives that it describes")
      .required();
  app.option("--objects", options.objects, "table of the drives' objects (YAML), as config/hardware/can_objects.yaml")
      .required();
  app.option("--bus", options.bus,
             "CAN interface, or a path: the socket of a simulated bus; default: the hardware file's interface");
  return nodes::runProgram(app, argc, argv, [&] { return simulate(options); });
}
