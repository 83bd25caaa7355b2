// Requests in any order, in any state, with faults between them: what must hold whatever is asked.
#include <random>

#include "holding_robot.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using namespace holding;

const char* const kRoamingPatient = R"(patient: "17"
pose: {X_m: [-0.1, 0.1], Z_m: [0.55, 0.72], theta_deg: [-12, 12], psi_deg: [-12, 12]}
)";

/// The table of docs/safety.md, written down once more: rows as MachineState, columns as RequestKind.
bool mayBeAsked(MachineState state, RequestKind kind) {
  static const std::array<std::string, kMachineStates> table = {
      "xx.xxx..xxx.",  // disabled
      ".x..x...x...",  // enabling
      ".xxxx...x..x",  // holding
      ".x.xx.xxx...",  // playing
      ".x.xx...x...",  // stopping
      ".x.xx...x...",  // safe_stopping
      "...xxx..x...",  // faulted
      ".x.xx.xxx...",  // paused
      ".x.xx...x...",  // homing
      ".x.xx...x...",  // guiding
  };
  return table[static_cast<std::size_t>(state)][static_cast<std::size_t>(kind)] == 'x';
}

/// What is true of outputs and platform in every millisecond.
class Invariants {
 public:
  void look(const HoldingRobot& robot, const std::string& last) {
    if (!robot.system) return;
    const ControlStatus now = robot.system->status();
    const std::uint8_t outputs = robot.image.counter.outputs.load();
    const bool drives = (outputs & 1) != 0, released = (outputs & 2) != 0;
    const bool off = now.state == MachineState::Disabled || now.state == MachineState::Faulted;
    if (released && !drives) tell("brakes released with the drives off", now, last);
    off_ms_ = off ? off_ms_ + 1 : 0;
    if (off_ms_ > 5 && (drives || released)) tell("outputs on", now, last);
    double volts = 0.0;
    for (const double one : simulation::outputVolts(robot.image.analog))
      volts = std::max(volts, std::abs(one));
    if (off_ms_ > 5 && volts > 0.01) tell("volts with the drives off", now, last);
    const mechanism::Lengths lengths = robot.plant.lengths();
    if (off_ms_ == 100) stood_m_ = lengths;
    const double sunk_m = off_ms_ > 100 ? (lengths - stood_m_).cwiseAbs().maxCoeff() : 0.0;
    if (sunk_m > 0.002 && now.fault != Fault::MovedWhileOff) tell("moves with the drives off", now, last);
    holding_ms_ = now.state == MachineState::Holding ? holding_ms_ + 1 : 0;
    if (holding_ms_ == 500) held_m_ = lengths;
    const double away_m = holding_ms_ > 500 ? (lengths - held_m_).cwiseAbs().maxCoeff() : 0.0;
    if (away_m > 0.005) tell("moves while holding", now, last);
    if (now.safe_stops > stops_ + 1) tell("more than one safe stop at once", now, last);
    stops_ = now.safe_stops;
  }
  std::vector<std::string> told;

 private:
  void tell(const std::string& what, const ControlStatus& now, const std::string& last) {
    const std::string sentence = what + " in " + toString(now.state) + " (" + now.fault_name + ") after " + last;
    if (told.size() < 5 && (told.empty() || told.back() != sentence)) told.push_back(sentence);
  }
  int off_ms_ = 0, holding_ms_ = 0;
  std::uint32_t stops_ = 0;
  mechanism::Lengths stood_m_ = mechanism::Lengths::Zero(), held_m_ = mechanism::Lengths::Zero();
};

/// One robot, one seed.
class Session {
 public:
  explicit Session(unsigned seed) : random_(seed), robot_(truth()) {
    writeFileAtomically(folder_ + "/p17.yaml", kRoamingPatient);
    robot_.system->setPlant([this](rt::Nanoseconds time) {
      while (robot_.plant.time() + 0.0005 < 1e-9 * static_cast<double>(time))
        robot_.plant.step(0.001);
      all.look(robot_, last_);
    });
  }
  void run(int requests) {
    for (int i = 0; i < requests; ++i) {
      if (pick(6) == 0) happens();
      ask();
      robot_.system->run(0.001 * pick(pick(4) == 0 ? 1500 : 120));
    }
    simulation::clear(robot_.image.faults);
  }
  Invariants all;
  int done = 0, refused = 0;

 private:
  static Truth truth() {
    Truth truth;
    truth.model = true;
    return truth;
  }
  int pick(int below) { return std::uniform_int_distribution<int>(0, below - 1)(random_); }

  /// Buttons and faults, and back again.
  void happens() {
    simulation::InjectedFaults& faults = robot_.image.faults;
    simulation::RobotSurroundings& people = robot_.image.surroundings;
    const auto axis = static_cast<std::size_t>(pick(4));
    const auto mask = static_cast<std::uint8_t>(1u << axis);
    switch (pick(9)) {
      case 0:
        people.emergency_stop_pressed.store(pick(2) ? 1 : 0);
        last_ = "emergency stop button";
        break;
      case 1:
        people.hand_switch_pressed.store(pick(2) ? 1 : 0);
        last_ = "hand switch";
        break;
      case 2:
        people.enabling_switch_held.store(pick(2) ? 1 : 0);
        break;
      case 3:
        faults.drive_dead.store(mask);
        last_ = "dead drive";
        break;
      case 4:
        robot_.freeze(axis);
        last_ = "frozen encoder " + std::to_string(axis + 1);
        break;
      case 5:
        faults.drive_late.store(mask);
        break;
      default:
        simulation::clear(faults);
        people.emergency_stop_pressed.store(0);
        people.hand_switch_pressed.store(0);
        break;
    }
  }
  trajectory::Reference lift() {
    trajectory::Reference reference;
    reference.name = "lift";
    const mechanism::Pose from = robot_.plant.state().pose;
    reference.points.resize(301, 4);
    for (int k = 0; k <= 300; ++k) {
      mechanism::Pose pose = from;
      pose[1] += 0.015 * (1.0 - std::cos(2.0 * M_PI * k / 300));
      reference.points.row(k) = mechanism::legLengths(*robot_.robot.mechanism, pose).transpose();
    }
    return reference;
  }
  Answer askFor(RequestKind kind) {
    ControlSystem& system = *robot_.system;
    switch (kind) {
      case RequestKind::Enable:
        return system.enable();
      case RequestKind::Disable:
        return system.disable();
      case RequestKind::Play:
        return system.play();
      case RequestKind::Stop:
        return system.stop();
      case RequestKind::EmergencyStop:
        return system.emergencyStop();
      case RequestKind::Reset:
        return system.resetFaults();
      case RequestKind::Pause:
        return system.pause();
      case RequestKind::Resume:
        return system.resume();
      case RequestKind::SetSpeed:
        return system.setSpeed(pick(140) - 20);
      case RequestKind::Home:
        return system.home();
      case RequestKind::ConfirmHome:
        return system.confirmHome();
      case RequestKind::Guide:
        return system.guide();
    }
    return {};
  }
  void ask() {
    ControlSystem& system = *robot_.system;
    const int what = pick(26);
    if (what < kRequestKinds) return askAs(static_cast<RequestKind>(what));
    last_ = "other " + std::to_string(what);
    switch (what) {
      case 12:
      case 13:
      case 14:
        askAs(RequestKind::Enable);
        return;
      case 15:
      case 16:
        askAs(RequestKind::Reset);
        return;
      case 17:
        try {
          system.loadReference(lift());
        } catch (const InputError&) {
        }
        return;
      case 18:
        system.approach();
        return;
      case 19:
        askAs(RequestKind::Play);
        return;
      case 20:
        system.declareEmpty();
        return;
      case 21:
        system.clearPatient();
        return;
      case 22:
        system.loadPatient(folder_ + "/p17.yaml");
        return;
      case 23:
      case 24:
        playsNow();
        return;
      case 25:
        system.setProperty("Feedforward", "payload_kg", std::to_string(pick(4)));
        return;
    }
  }
  void playsNow() {
    try {
      robot_.system->loadReference(lift());
    } catch (const InputError&) {
    }
    robot_.system->play();
    last_ = "play";
  }
  void askAs(RequestKind kind) {
    const MachineState before = robot_.system->state();
    last_ = "request " + std::to_string(static_cast<int>(kind)) + " in " + toString(before);
    const Answer answer = askFor(kind);
    (answer.ok ? done : refused) += 1;
    // A state that passes by itself may have passed when the request is read.
    const bool passes = before != MachineState::Disabled && before != MachineState::Faulted;
    if (answer.ok && !mayBeAsked(before, kind) && !passes && kind != RequestKind::SetSpeed)
      all.told.push_back("answered with success: " + last_);
  }

  std::mt19937 random_;
  const TemporaryFolder folder_;
  std::string last_ = "the start";
  HoldingRobot robot_;
};

TEST(RandomRequests, NeverLeaveADriveOnAloneNorABrakeOpenWithoutIt) {
  int done = 0, refused = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Session session(seed);
    session.run(150);
    done += session.done;
    refused += session.refused;
    for (const std::string& sentence : session.all.told)
      ADD_FAILURE() << "seed " << seed << ": " << sentence;
  }
  std::printf("%d requests done, %d refused\n", done, refused);
  EXPECT_GT(done, 100);
}

}  // namespace
}  // namespace knee_robot::control
