// ROS node `controller`: Sync, four Drivers and their supervision on the cards or on the simulated robot. Parameters:
// see kParameters and launch/controller.launch. SIGINT and SIGTERM end in the safe stop. When the ROS master is lost,
// what moves is stopped along its path and disabled; when a master is there again, everything is advertised anew
// (docs/ros_interface.md).

#include <ros/ros.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <memory>
#include <thread>

#include "controller_interface.h"
#include "impatient_launch.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/control/model_feedforward.h"
#include "logger_services.h"
#include "loopback.h"
#include "master_watch.h"
#include "out_of_memory.h"
#include "output_relay.h"
#include "own_session.h"
#include "parameters.h"
#include "program.h"
#include "request_depth.h"
#include "request_errors.h"
#include "same_name.h"
#include "signals.h"
#include "state_folder.h"

namespace {

using namespace knee_robot;

volatile std::sig_atomic_t stop_requested = 0;

constexpr const char* kParameters =
    R"(It takes ROS parameters, as launch/controller.launch sets them: rosrun knee_robot controller _robot:=A.yaml ...
  ~robot, ~hardware, ~deployment  files of the robot, of its cards and of the components; required
  ~references, ~recordings        folders from which references are loaded and to which recordings go; required
  ~patients                       folder of patient files; default: ~references
  ~state                          folder of what a restart must not forget: the patient that was loaded, the motors' heat;
                                  default: ~recordings/black_box
  ~events                         folder of the event log; default: ~recordings/events
  ~empty                          true: nobody is on the robot (default false)
  ~model                          model file of identify or trace for the feedforward; default: the weights of the URDF
  ~payload_kg                     payload that the feedforward is told of; default: the deployment's
  ~guardian, ~silent_guardian_ms  shared memory with the guardian (default: none), and its silence that stops (50)
  ~shm                            shared memory of simulated cards; unused with real ones
  ~can                            CAN interface; default: the hardware file's
  ~cpu                            processor that the servo cycle is bound to; default: the deployment's
  ~rate_hz                        rate of the topics (50)
  ~master_timeout_s               time without a ROS master after which what moves is stopped (2; 0: never)
  ~diagnostics/...                thresholds of the diagnostics: docs/ros_interface.md)";

/// Without a master no operator's tool finds the controller, and without descriptors none reaches it: what moves is
/// stopped along its path, and the drives are switched off.
class Unreachable {
 public:
  Unreachable(control::ControlSystem& system, nodes::EventLog& log, double timeout_s)
      : system_(system), log_(log), timeout_s_(timeout_s) {}
  /// For how long this thread was gone when it meant to sleep for some milliseconds. Where it is seconds the whole process
  /// stood still, and who did not answer meanwhile is not to blame.
  void slept(double time_s) {
    const auto now = std::chrono::steady_clock::now();
    if (time_s > 0.5 * timeout_s_) {
      stood_still_s_ = time_s;
      woken_ = now;
    }
    if (now - woken_ > std::chrono::duration<double>(timeout_s_)) stood_still_s_ = 0.0;
  }
  /// For how long the master has been gone, and no new client has been answered, s.
  void poll(double silence_s, double unreached_s) {
    if (timeout_s_ == 0.0 || std::max(silence_s, unreached_s) < timeout_s_) {
      acted_ = false;
      return;
    }
    const control::MachineState state = system_.state();
    if (state == control::MachineState::Disabled || state == control::MachineState::Faulted) {
      acted_ = false;
      return;
    }
    // Refused, or enabled anew by whoever is still connected: again. In a safe stop that goes on (a brake slips) the
    // drives carry.
    const bool again = state != control::MachineState::SafeStopping && std::chrono::steady_clock::now() >= again_at_;
    if (acted_ && !again) return;
    acted_ = true;
    const std::string why = stood_still_s_ > 0.0 ? "the controller's process stood still"
                            : silence_s < timeout_s_
                                ? "no new client reaches the controller (too many connections to it?)"
                                : "the ROS master is gone";
    log_.add("controller", "", why + ": stopping along the path, then disabling");
    ROS_ERROR("%s for %.1f s: stopping along the path, then disabling", why.c_str(), std::max(silence_s, unreached_s));
    if (system_.stop().ok) system_.waitFor(control::MachineState::Holding, 10.0);
    const control::Answer answer = system_.disable();
    acted_ = !answer.ok;
    again_at_ = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    log_.add("controller", "", why, answer.sentence);
    ROS_ERROR("%s: %s", why.c_str(), answer.sentence.c_str());
  }

 private:
  control::ControlSystem& system_;
  nodes::EventLog& log_;
  const double timeout_s_;
  bool acted_ = false;  // and was refused
  double stood_still_s_ = 0.0;
  std::chrono::steady_clock::time_point woken_;
  std::chrono::steady_clock::time_point again_at_;
};

/// What ROS sees of the controller. It is made anew in a thread of its own: taking the old one down waits for calls
/// under way, one of which may wait for a disk.
class Interface {
 public:
  explicit Interface(const nodes::ControllerInterface::Parts& parts) : parts_(parts) {
    interface_ = std::make_unique<nodes::ControllerInterface>(parts_);
  }
  /// True when it has been made anew since it was asked for last.
  bool renew() {
    if (!renewing_.valid()) {
      began_ = std::chrono::steady_clock::now();
      renewing_ = std::async(std::launch::async, [this] {
        interface_.reset();
        interface_ = std::make_unique<nodes::ControllerInterface>(parts_);
      });
    }
    if (renewing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    renewing_.get();
    return true;
  }
  /// For how long nobody who asks the master finds it, s.
  double absence() const {
    if (!renewing_.valid()) return 0.0;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }

 private:
  const nodes::ControllerInterface::Parts parts_;
  std::unique_ptr<nodes::ControllerInterface> interface_;
  std::future<void> renewing_;  // ends first
  std::chrono::steady_clock::time_point began_;
};

/// Threads that wait for a disk cannot be joined. With the drives off nothing is lost but what the disk did not take
/// anyway.
void endEvenIfTheDiskHangs() {
  constexpr auto kPatience = std::chrono::seconds(12);
  std::thread([kPatience] {
    std::this_thread::sleep_for(kPatience);
    std::fprintf(stderr, "controller: ended without waiting any longer for a disk or a call that does not come back\n");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // until it is handed on
    std::_Exit(1);
  }).detach();
}

void sayWhyAnew(const nodes::MasterWatch& watch, nodes::EventLog& log) {
  const char* const why = watch.isRobbed()
                              ? "another node has taken the name of a service that stops the robot, or of get_state"
                              : "the ROS master does not know this node's services any more (was it restarted?)";
  log.add("controller", "", why, "advertising everything anew");
  ROS_WARN("%s: advertising everything anew", why);
}

void serve(const ros::NodeHandle& node, nodes::Machine& machine, const nodes::ControllerInterface::Parts& parts,
           std::atomic<nodes::GuardianSupervision::Guardian>& guardian) {
  const double timeout_s = nodes::numberParameter(node, "master_timeout_s", 2.0, 0.0, 60.0,
                                                  "how long the ROS master may be gone; 0: for ever");
  ros::master::setRetryTimeout(ros::WallDuration(5.0));  // never wait for ever for a master that goes away again
  Interface interface(parts);
  nodes::GuardianSupervision supervision(machine);
  Unreachable unreachable(parts.system, parts.log, timeout_s);
  std::vector<std::string> stops;
  for (const char* name : {"emergency_stop", "stop", "pause", "disable", "set_speed"})
    stops.push_back(node.resolveName(name));
  nodes::MasterWatch watch(node.resolveName("get_state"), stops);
  while (!stop_requested && ros::ok()) {
    guardian = supervision.poll();
    unreachable.poll(std::max(watch.silence(), interface.absence()), watch.sinceReached());
    if (watch.isForgotten()) {
      if (interface.absence() == 0.0) sayWhyAnew(watch, parts.log);
      if (interface.renew()) watch.remember();
    }
    const auto before = std::chrono::steady_clock::now();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    unreachable.slept(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
  }
  // Drives off now: taking the interface down waits for the master and for calls under way, one of which may wait for a
  // disk.
  parts.system.refuseToMove();
  parts.system.stop();
  parts.system.disable();
  if (parts.system.outputsAreOff()) endEvenIfTheDiskHangs();
}

void refuseASecondOne() {
  const std::string other = nodes::nodeOfTheSameName();
  if (other.empty()) return;
  throw InputError("a node " + ros::this_node::getName() + " is running already (" + other +
                   "): registering this one would shut it down, and stop its robot; end it first, or give this one a "
                   "name of its own (__name:=..., or a namespace)");
}

control::ControlSystem::Options readOptions(const ros::NodeHandle& node, const std::string& recordings) {
  control::ControlSystem::Options options;
  options.black_box_folder = recordings + "/black_box";
  std::string state = nodes::folderParameter(node, "state", options.black_box_folder);
  if (state != options.black_box_folder) state += ros::this_node::getNamespace();  // of one robot of several
  options.heat_file = nodes::keptIn(state, options.black_box_folder, "heat.yaml");
  options.patient_memory = nodes::keptIn(state, options.black_box_folder, "patient.txt");
  options.empty = nodes::switchParameter(node, "empty", false, "whether nobody is on the robot");
  options.model = nodes::textParameter(node, "model", "", "a model file, or nothing");
  if (node.hasParam("payload_kg")) {
    options.payload_kg =
        nodes::numberParameter(node, "payload_kg", 0.0, 0.0, control::ModelFeedforward::kLargestPayload_kg,
                               "the payload that the feedforward is told of, in kg");
  }
  if (node.hasParam("cpu")) {
    const double cpu = nodes::numberParameter(node, "cpu", 0.0, 0.0, 1023.0, "the number of a processor");
    if (cpu != std::floor(cpu)) throw InputError("parameter " + node.resolveName("cpu") + " is no whole number");
    options.cpu = static_cast<int>(cpu);
  }
  return options;
}

/// The exit status.
int shutDown(control::ControlSystem& system, nodes::EventLog& log) {
  const std::string timing = rt::toText(system.statistics());
  control::Answer stopped = system.shutdown();
  while (!stopped.ok && system.drivesCarry()) {  // only the drives carry the platform
    ROS_ERROR("%s", stopped.sentence.c_str());
    std::this_thread::sleep_for(std::chrono::seconds(5));
    stopped = system.shutdown();
  }
  log.add("controller", "", "end", stopped.sentence);
  std::printf("controller: timing since the start\n%s", timing.c_str());
  std::printf("controller: %s\n", stopped.sentence.c_str());
  return stopped.ok ? kExitDone : 1;
}

int run() {
  refuseASecondOne();
  ros::NodeHandle node("~");
  nodes::withdrawLoggerList();
  if (ros::Time::isSimTime()) {
    throw InputError(
        "the parameter /use_sim_time is true: stamps and goals would follow whoever publishes /clock; "
        "rosparam set /use_sim_time false, and start again");
  }
  const mechanism::Robot robot = mechanism::loadRobot(nodes::requiredParameter(node, "robot"));
  control::HardwareFile hardware_file = control::loadHardwareFile(nodes::requiredParameter(node, "hardware"));
  if (hardware_file.can)
    hardware_file.can->interface = nodes::textParameter(node, "can", hardware_file.can->interface, "a CAN interface");
  const double rate_hz = nodes::numberParameter(node, "rate_hz", 50.0, 1.0, 500.0, "the rate of the topics");
  const nodes::Folder reference_folder(nodes::requiredParameter(node, "references"));
  const nodes::Folder patients(nodes::textParameter(node, "patients", reference_folder.path(), "a folder"));
  const nodes::Folder recordings(nodes::requiredParameter(node, "recordings"));
  nodes::Machine machine = nodes::openMachine(hardware_file, robot, node, [] { return stop_requested != 0; });

  control::ControlSystem system(robot, hardware_file, nodes::requiredParameter(node, "deployment"), machine.bus(),
                                readOptions(node, recordings.path()));
  nodes::EventLog log(nodes::folderParameter(node, "events", recordings.path() + "/events") + "/controller.jsonl");
  const control::Answer started = system.start();
  log.add("controller", "", "start", started.sentence);
  if (!started.ok) throw InputError(started.sentence);
  for (const std::string& warning : system.warnings())
    ROS_WARN("NOT REAL TIME: %s", warning.c_str());
  if (hardware_file.backend != "simulated" && nodes::killsTooSoon(nodes::commandOfParent())) {
    ROS_WARN(
        "roslaunch kills controller and guardian 17 s after Ctrl-C, also when a holding brake does not hold and the "
        "drives carry the platform: give it, and the guardian, the argument --own-session, as controller.launch "
        "does with own_session:=true");
  }
  ROS_INFO("%s", started.sentence.c_str());
  ROS_INFO("feedforward: %s", system.feedforward().c_str());
  nodes::References references(system, reference_folder);
  std::atomic<nodes::GuardianSupervision::Guardian> guardian{nodes::GuardianSupervision::Guardian::None};
  serve(node, machine, {system, robot, references, patients, recordings, rate_hz, guardian, log}, guardian);
  return shutDown(system, log);
}

}  // namespace

int main(int argc, char** argv) {
  nodes::openStandardStreams();
  nodes::continueInOwnSession(argc, argv);
  nodes::limitDescriptors();
  nodes::endOthersFirst(nodes::kLast);
  const nodes::OutputRelay relay;  // before all others: no thread waits for whoever reads what is said
  nodes::keepToLoopback();
  nodes::limitRequestDepth();
  nodes::answerRequestErrors();
  ros::init(argc, argv, "controller", ros::init_options::NoSigintHandler);
  nodes::takeSignals([](int) { stop_requested = 1; });
  nodes::CommandLine app("Drives the robot: servo cycle, supervision, services, topics and the action. A ROS node.",
                         "controller");
  app.serves();
  bool own_session = false;
  app.flag(nodes::kOwnSession, own_session,
           "go on in a session of its own, so that roslaunch cannot kill what carries");
  app.footer(kParameters);
  return nodes::runProgram(app, argc, argv, run);  // what is thrown: unwinding has shut the robot down in order
}
