// guardian --hardware H [--shm NAME] [--link NAME]: watches the controller from a process of its own with its own
// handle to the cards, and brings the outputs down when the controller dies or falls silent while drives are on. No
// ROS.
// guardian --down-now: fences a controller out, brings the outputs down once and ends; for the service manager's hooks.

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <optional>
#include <stdexcept>
#include <thread>

#include "backends.h"
#include "down_now.h"
#include "guardian_heir.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/control/guardian.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/hardware/machine_lock.h"
#include "knee_robot/hardware/process_watch.h"
#include "knee_robot/rt/activity.h"
#include "out_of_memory.h"
#include "own_session.h"
#include "program.h"
#include "signals.h"

namespace {

using namespace knee_robot;

constexpr rt::Nanoseconds kPeriod = 1'000'000;
volatile std::sig_atomic_t stop_requested = 0;

hardware::EmergencyOutputs* outputs_at_the_end = nullptr;

/// The link's file was cut off: the controller, which looks at it before every write, dies of that, too. Twice, for a
/// write under way.
void bringDownAndDie(int) {
  constexpr timespec kWriteUnderWay{0, 5'000'000};
  constexpr char kSentence[] = "guardian: the link's memory is gone (was its file truncated?): outputs down\n";
  for (int i = 0; i < 2 && outputs_at_the_end != nullptr; ++i) {
    outputs_at_the_end->down();
    ::nanosleep(&kWriteUnderWay, nullptr);
  }
  const ssize_t told = ::write(STDERR_FILENO, kSentence, sizeof kSentence - 1);
  ::_exit(told > 0 ? 1 : 2);
}

void pause() {
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

void tellTrip(const control::GuardianReport& report) {
  const std::int32_t pid = report.controller_pid.load();
  // pid 0: it ended in order, but could not write the outputs any more.
  const char* what = pid == 0                                                     ? "has ended"
                     : report.cause.load() == control::GuardianCause::ProcessGone ? "has died"
                     : report.cause.load() == control::GuardianCause::LockedOut   ? "was locked out (--down-now)"
                                                                                  : "is silent";
  const double reaction_ms = rt::toSeconds(report.reaction.load()) * 1e3;
  const double carried_ms = rt::toSeconds(report.carried.load()) * 1e3;
  std::printf(
      "guardian: TRIPPED: controller (process %d) %s while drives were on; holding brakes ordered %.2f ms after its "
      "last heartbeat (writes %.3f ms), outputs %s%s; fenced out until reset\n",
      pid, what, reaction_ms, rt::toSeconds(report.writing.load()) * 1e3,
      report.written.load() ? "down" : "NOT ALL DOWN, a card refused",
      carried_ms > 0.0
          ? (" after the " + shortNumber(carried_ms, 3) + " ms that they take, carried by the drives until then")
                .c_str()
          : "");
  if (carried_ms > 0.0 && !report.written.load()) {
    std::printf(
        "guardian: THE CARD WITH THE DIGITAL OUTPUTS DOES NOT ANSWER, and no brake can be engaged: until it does, the "
        "drives keep what carried the platform at rest; support it, then press the emergency stop and "
        "kill this process\n");
  }
  std::fflush(stdout);
}

void tellSlip(const control::GuardianReport& report, int& told) {
  const int axis = report.slipped.load();
  if (axis != 0 && told == 0) {
    std::printf(
        "guardian: THE HOLDING BRAKE OF AXIS %d DID NOT HOLD when it should: the drives carry on, for %g s at most; "
        "support the platform, then mend the brake\n",
        axis, rt::toSeconds(control::GuardianHandOver::kLongest));
    std::fflush(stdout);
  }
  told = axis;
}

/// A controller that ends with its guardian, as roslaunch ends both, goes first: it calls a guardian that goes before
/// it a fault.
class ControllersTime {
 public:
  /// After the stop was asked for: the controller has not ended, and may still.
  bool lasts(const hardware::GuardianLink& link) {
    const std::int32_t controller = link.controller_pid.load();
    return controller > 0 && rt::monotonicNow() < end() && !watch_.isGone(controller);
  }

 private:
  static constexpr double kLongest_s = 3.0;

  rt::Nanoseconds end() {
    if (end_ == 0) end_ = rt::monotonicNow() + rt::fromSeconds(kLongest_s);
    return end_;
  }

  hardware::ProcessWatch watch_;
  rt::Nanoseconds end_ = 0;
};

/// Says once that somebody has removed the link's name.
class RemovedLink {
 public:
  void look(const hardware::SharedGuardianLink& memory) {
    if (told_ || ++pauses_ % 200 != 0 || memory.isNamed()) return;
    told_ = true;
    std::fprintf(
        stderr,
        "guardian: SOMEBODY HAS REMOVED %s from /dev/shm: a controller that is started again will not find this "
        "guardian; disable the robot, end both, and start both\n",
        memory.name().c_str());
  }

 private:
  std::uint32_t pauses_ = 0;
  bool told_ = false;
};

/// Says once that the guardian's heir is gone.
class LostHeir {
 public:
  explicit LostHeir(std::int32_t heir) : heir_(heir) {}
  void look() {
    if (heir_ == 0 || (heir_ > 0 && ::waitpid(heir_, nullptr, WNOHANG) == 0)) return;
    heir_ = 0;
    std::fprintf(stderr,
                 "guardian: ITS HEIR IS GONE: nobody hands over if this process dies together with the controller; "
                 "disable the robot and start the guardian again\n");
  }

 private:
  std::int32_t heir_;  // 0: there is none to be missed
};

/// Reports until a signal comes; and then as long as drives are on: what it is there for may still happen, or is just
/// happening.
void reportUntilDone(const control::Guardian& guardian, hardware::SharedGuardianLink& memory, std::int32_t heir) {
  const control::GuardianReport& report = guardian.report();
  const hardware::GuardianLink& link = memory.link();
  std::uint32_t told = 0;
  int slip_told = 0;
  RemovedLink removed;
  LostHeir lost(heir);
  ControllersTime controllers_time;
  while (!stop_requested || controllers_time.lasts(link) || (link.armed.load() != 0 && link.tripped.load() == 0) ||
         report.acts.load()) {
    pause();
    if (guardian.isReplaced()) throw std::runtime_error("stood still, and its heir has acted in its place");
    removed.look(memory);
    lost.look();
    tellSlip(report, slip_told);
    const std::uint32_t trips = report.trips.load(std::memory_order_acquire);
    if (trips == told) continue;
    told = trips;
    tellTrip(report);
  }
}

struct Options {
  std::string hardware_file, can, shm = "/knee_robot_sim", link = "/knee_robot_guardian";
  double silence_ms = 10.0;
  int priority = 90, cpu = -1;
  bool require_real_time = false, down_now = false, own_session = false;
};

nodes::Site siteOf(const Options& options) {
  return {options.shm, [] { return stop_requested != 0; }};
}

control::HardwareFile loadFile(const Options& options) {
  control::HardwareFile file = control::loadHardwareFile(options.hardware_file);
  if (file.can && !options.can.empty()) file.can->interface = options.can;
  return file;
}

/// The link, where there is one and it is this machine's; a sentence where not. Outputs come down without it, too.
std::optional<hardware::SharedGuardianLink> linkOf(const std::string& name, const std::string& machine) {
  try {
    hardware::SharedGuardianLink memory = hardware::SharedGuardianLink::open(name);
    const std::uint64_t mark = memory.link().machine.load();
    if (mark == 0 || mark == hardware::machineMark(machine)) return memory;
    std::fprintf(stderr, "guardian: %s is another machine's; nobody is fenced out there\n", name.c_str());
  } catch (const InputError& error) {
    std::fprintf(stderr, "guardian: nobody is fenced out: %s\n", error.what());
  }
  return std::nullopt;
}

control::GuardianCarry carryOf(const control::HardwareFile& file) {
  return {static_cast<std::uint8_t>(1u << file.drive_enable_bit), static_cast<std::uint8_t>(1u << file.heartbeat_bit),
          rt::fromSeconds(file.holdDelay()), file.holdsByBrakes()};
}

/// What a service manager calls after the controller or its guardian has ended, for whatever reason. Beside a guardian
/// that lives a controller is fenced out at once, and that one hands the load over; without one it is first given the
/// time to stop by itself, and left alone where it goes on carrying.
int bringDownNow(const Options& options) {
  const control::HardwareFile file = loadFile(options);
  const std::unique_ptr<hardware::EmergencyOutputs> outputs = nodes::openOutputs(file, siteOf(options));
  const std::string machine = nodes::machineName(file, siteOf(options));
  std::optional<hardware::SharedGuardianLink> memory = linkOf(options.link, machine);
  const bool beside_a_stranger = nodes::isBesideAStranger(memory ? &memory->link() : nullptr, machine);
  if (memory) {
    const bool guarded = nodes::guardianActs(memory->link());
    if (!guarded && !nodes::letControllerStop(memory->link())) {
      std::printf("guardian: the controller lives and its drives carry the platform; start the guardian again\n");
      return 1;
    }
    if (!guarded) nodes::handOverInItsPlace(memory->link(), *outputs, carryOf(file), 10 * kPeriod);
    memory->link().tripped.store(1);
    if (guarded) nodes::letGuardianSee(memory->link());
    if (!hardware::letGuardianHandOver(memory->link())) {
      std::printf(
          "guardian: another one still lets the drives carry the platform, for a holding brake does not hold or cannot "
          "be ordered to; support it, then end that one\n");
      return 1;
    }
  }
  hardware::IoStatus status = outputs->down();
  if (memory) memory->link().acts.store(0);  // of a guardian that has died of it
  pause();
  if (const hardware::IoStatus again = outputs->down(); again != hardware::IoStatus::Ok)
    status = again;  // a write under way
  std::printf("guardian: outputs %s%s\n", status == hardware::IoStatus::Ok ? "down" : "NOT ALL DOWN, a card refused",
              memory && !beside_a_stranger ? "; a controller is fenced out until reset" : "");
  if (beside_a_stranger) {
    std::printf(
        "guardian: BUT A CONTROLLER LIVES that %s does not reach (its link is of another version, or was removed): it "
        "may have switched them on again; end it, or press the emergency stop\n",
        options.link.c_str());
  }
  return status == hardware::IoStatus::Ok && !beside_a_stranger ? kExitDone : 1;
}

/// Called in the heir's process. Drives on CAN stop by themselves, and hand nothing over.
nodes::GuardianHeir heirOf(const control::HardwareFile& file, const Options& options) {
  nodes::GuardianHeir heir;
  heir.outputs = nodes::openOutputs(file, siteOf(options));
  outputs_at_the_end = heir.outputs.get();
  heir.carry = carryOf(file);
  heir.silence = rt::fromSeconds(options.silence_ms * 1e-3);
  heir.priority = options.priority;
  return heir;
}

/// A controller that has this machine, but not this link, would be disturbed, and not guarded. One that is just starting
/// is about to be in the link.
void refuseBesideAStranger(const hardware::GuardianLink& link, const std::string& machine) {
  for (int pauses = 0; hardware::MachineLock::isTaken("controller", machine); ++pauses) {
    const std::int32_t controller = link.controller_pid.load();
    if (stop_requested || (controller > 0 && !hardware::ProcessWatch().isGone(controller))) return;
    if (pauses >= 600) {
      throw InputError("a controller has the machine " + machine +
                       " already and was not told of this guardian; end it first");
    }
    pause();
  }
}

int run(const Options& options) {
  const control::HardwareFile file = loadFile(options);
  hardware::SharedGuardianLink memory = hardware::SharedGuardianLink::open(options.link);
  const std::int32_t heir = file.can ? 0 : nodes::keepHeir(memory.link(), [&] { return heirOf(file, options); });
  if (const std::int32_t other = nodes::takeGuard(memory.link()); other != 0)
    throw InputError("process " + std::to_string(other) + " already guards " + options.link + "; end it first");
  const std::string machine = nodes::machineName(file, siteOf(options));
  const hardware::MachineLock lock = hardware::MachineLock::take("guardian", machine);
  memory.link().machine.store(hardware::machineMark(machine));
  memory.link().wiring.store(nodes::wiringMark(file));
  memory.link().silence_ns.store(rt::fromSeconds(options.silence_ms * 1e-3));
  const std::unique_ptr<hardware::EmergencyOutputs> outputs = nodes::openOutputs(file, siteOf(options));
  outputs_at_the_end = outputs.get();
  refuseBesideAStranger(memory.link(), machine);
  control::Guardian guardian(memory.link(), *outputs, rt::fromSeconds(options.silence_ms * 1e-3), kPeriod,
                             rt::monotonicNow, carryOf(file));
  rt::ActivityOptions activity_options;
  activity_options.name = "guardian";
  activity_options.period = kPeriod;
  activity_options.priority = options.priority;
  activity_options.cpu = options.cpu;
  activity_options.require_real_time = options.require_real_time;
  activity_options.overrun_limit = 0;
  rt::PeriodicActivity activity(activity_options);
  activity.add(guardian, 0);
  const std::uint64_t before = memory.link().guardian_cycles.load();
  if (!guardian.configure() || !guardian.start()) throw InputError(guardian.refusal());
  for (const std::string& lacking : activity.start(rt::monotonicNow()))
    std::fprintf(stderr, "guardian: NOT REAL TIME: %s\n", lacking.c_str());
  while (memory.link().guardian_cycles.load() == before && !stop_requested && !guardian.isReplaced())
    pause();
  if (guardian.report().went_on.load()) {
    std::printf(
        "guardian: another one has died while the drives carried the platform: goes on until the brakes hold\n");
  }
  if (guardian.report().found_nobody.load()) {
    std::printf("guardian: no controller holds %s: outputs %s\n", options.link.c_str(),
                guardian.report().written.load() ? "brought down" : "NOT ALL DOWN, a card refused");
  }
  std::printf(
      "guardian ready: %s, acts when the controller is gone or silent for %g ms%s\n", options.link.c_str(),
      options.silence_ms,
      guardian.report().trips.load() == 0 && memory.link().tripped.load() != 0 && !guardian.report().went_on.load()
          ? "; TRIPPED already, outputs down"
          : "");
  std::fflush(stdout);
  reportUntilDone(guardian, memory, heir);
  activity.stop();
  outputs_at_the_end = nullptr;
  std::printf("guardian ends: drives are off\n");
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  nodes::continueInOwnSession(argc, argv);
  nodes::endOthersFirst(nodes::kNever);
  nodes::CommandLine app("Watches the controller and brings the outputs down when it dies or falls silent.",
                         "guardian");
  app.serves();
  Options options;
  app.option("--hardware", options.hardware_file, "hardware file (YAML)").required();
  app.option("--shm", options.shm, "shared memory of the simulated robot, for backend simulated").showDefault();
  app.option("--can", options.can,
             "CAN interface or simulated bus' path, for backend can; default: the hardware file's");
  app.option("--link", options.link, "shared memory between controller and guardian").showDefault();
  app.option("--silence-ms", options.silence_ms,
             "the controller counts as dead after this time without a heartbeat, ms")
      .within(3.0, 10000.0)
      .showDefault();
  app.option("--priority", options.priority, "SCHED_FIFO priority, above the controller's; 0: none")
      .within(0, 98)
      .showDefault();
  app.option("--cpu", options.cpu, "processor to run on; -1: any").showDefault();
  app.flag("--require-real-time", options.require_real_time, "refuse to start without real-time privileges");
  app.flag(nodes::kOwnSession, options.own_session, "go on in a session of its own, so that roslaunch cannot kill it");
  app.flag("--down-now", options.down_now, "lock out a running controller, bring the outputs down once, and end");
  app.allowExtras();  // roslaunch appends __name:= and __log:=
  return nodes::runProgram(app, argc, argv, [&] {
    nodes::takeSignals([](int) { stop_requested = 1; });
    std::signal(SIGBUS, bringDownAndDie);
    return options.down_now ? bringDownNow(options) : run(options);
  });
}
