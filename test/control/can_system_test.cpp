// The whole controller on four simulated CiA 402 drives: a motion, and every fault of bus and drives during a motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "knee_robot/base/errors.h"
#include "test/control/can_rig.h"
#include "test/refusal.h"

namespace knee_robot::fake {
namespace {

namespace can = hardware::can;

constexpr unsigned kAll = 0x0F;

TEST(CanSystem, PlaysAMotionAndStopsWithBrakesEngaged) {
  CanRig rig;
  const control::Answer started = rig.play();
  ASSERT_TRUE(started.ok) << started.sentence;
  ASSERT_EQ(rig.system.state(), control::MachineState::Playing) << rig.system.status().fault_sentence;
  double worst = 0.0;
  for (int i = 0; i < 1500 && rig.system.state() == control::MachineState::Playing; ++i) {
    rig.system.step();
    const auto row = rig.system.snapshot();
    for (std::size_t axis = 0; axis < 4; ++axis)
      worst = std::max(worst, std::abs(row->reference_m[axis] - row->position_m[axis]));
  }
  EXPECT_EQ(rig.system.state(), control::MachineState::Holding) << rig.system.status().fault_sentence;
  RecordProperty("largest_tracking_error_um", static_cast<int>(worst * 1e6));
  EXPECT_LT(worst, 1e-3);
  const auto row = rig.system.snapshot();
  for (std::size_t axis = 0; axis < 4; ++axis)
    EXPECT_NEAR(row->position_m[axis], rig.robot.actuators[axis].home_length_m + 0.02, 2e-4);
  const control::Answer stopped = rig.system.disable();
  EXPECT_TRUE(stopped.ok) << stopped.sentence;
  rig.system.run(0.2);
  EXPECT_EQ(rig.brakesEngaged(), kAll);
  EXPECT_EQ(rig.drivesEnabled(), 0u);
}

TEST(CanSystem, GivesNoTorqueBeforeOperationEnabled) {
  CanRig rig;
  rig.wire.logging = true;
  ASSERT_TRUE(rig.hold().ok);
  std::array<bool, 5> enabled{};
  int commands = 0;
  for (const can::Frame& frame : rig.wire.log) {
    const std::uint32_t node = frame.id & 0x7F;
    if (frame.id == can::kTransmitPdoBase + node && node >= 1 && node <= 4) {
      enabled[node] =
          can::stateOf(static_cast<std::uint16_t>(can::unsignedAt(frame, 0, 2))) == can::DriveState::OperationEnabled;
    }
    if (frame.id != can::kReceivePdoBase + node || node < 1 || node > 4) continue;
    ++commands;
    if (!enabled[node]) {
      ASSERT_EQ(can::unsignedAt(frame, 2, 2), 0u);
    }
  }
  EXPECT_GT(commands, 100);
}

struct FaultCase {
  const char* name;
  const char* fault;
  int axis;
  std::function<void(CanRig&)> begin;
  std::function<void(CanRig&)> each_cycle;
  std::function<void(CanRig&)> end;
};

can::Frame busOffFrame() {
  can::Frame frame;
  frame.error = true;
  frame.id = 0x40;
  frame.length = 8;
  return frame;
}

can::Frame restartedFrame() {
  can::Frame frame = busOffFrame();
  frame.id = 0x100;
  return frame;
}

bool isFeedback(const can::Frame& frame) {
  return frame.id > 0x180 && frame.id <= 0x1FF;
}

/// Feedback of every third period comes a period late, together with that one's.
void delayFeedback(CanRig& rig) {
  auto held = std::make_shared<std::vector<can::Frame>>();
  auto count = std::make_shared<int>(0);
  rig.wire.passes_to_controller = [=, &rig](can::Frame& frame) {
    if (!isFeedback(frame)) return true;
    if ((*count)++ % 12 < 4) {
      held->push_back(frame);
      return false;
    }
    std::vector<can::Frame> late;
    late.swap(*held);
    for (const can::Frame& one : late)
      rig.wire.inject(one);
    return true;
  };
}

/// Two feedbacks of one drive change places: the older comes after the newer.
void reorderFeedback(CanRig& rig) {
  auto held = std::make_shared<std::optional<can::Frame>>();
  rig.wire.passes_to_controller = [=, &rig](can::Frame& frame) {
    if (frame.id != can::kTransmitPdoBase + 3) return true;
    if (!*held) {
      *held = frame;
      return false;
    }
    const can::Frame older = **held;
    held->reset();
    rig.wire.inject(frame);
    rig.wire.inject(older);
    return false;
  };
}

/// Hundreds of copies of one old feedback in each cycle: more than can be read, so what is read is old.
void flood(CanRig& rig) {
  static can::Frame old;
  if (rig.wire.log.empty()) {
    rig.wire.logging = true;
    return;
  }
  rig.wire.logging = false;
  for (const can::Frame& frame : rig.wire.log)
    if (frame.id == can::kTransmitPdoBase + 2) old = frame;
  for (int i = 0; i < 200; ++i)
    rig.wire.inject(old);
}

void passAll(CanRig& rig) {
  rig.wire.passes_to_controller = nullptr;
  rig.wire.passes_to_drives = nullptr;
}

const std::vector<FaultCase>& faultCases() {
  static const std::vector<FaultCase> cases = {
      {"NodeLost", "drive_lost", 2, [](CanRig& rig) { rig.plant.drive(1).setSilent(true); }, nothing,
       [](CanRig& rig) { rig.plant.drive(1).setSilent(false); }},
      {"DriveHeartbeatLost", "drive_heartbeat_lost", 4, [](CanRig& rig) { rig.plant.drive(3).setHeartbeat(false); },
       nothing, [](CanRig& rig) { rig.plant.drive(3).setHeartbeat(true); }},
      {"ControllerHeartbeatLost", "controller_heartbeat_lost", 1,
       [](CanRig& rig) {
         rig.wire.passes_to_drives = [](const can::Frame& frame) { return frame.id != can::kHeartbeatBase + 126; };
       },
       nothing, passAll},
      {"Emergency", "drive_emergency", 3, [](CanRig& rig) { rig.plant.drive(2).warn(0x4210); }, nothing, nothing},
      {"DriveFault", "drive_fault", 2, [](CanRig& rig) { rig.plant.drive(1).fail(0x2310); }, nothing, nothing},
      {"DriveDisabledByItself", "drive_not_enabled", 1,
       [](CanRig& rig) {
         rig.wire.inject(can::requestFrame(1, {true, can::objects::kControlWord, 2, can::kDisableVoltage}));
       },
       nothing, nothing},
      {"BusOff", "bus_off", 0, [](CanRig& rig) { rig.wire.inject(busOffFrame()); },
       [](CanRig& rig) { rig.wire.full = true; },
       [](CanRig& rig) {
         rig.wire.full = false;
         rig.wire.inject(restartedFrame());
       }},
      {"FrameFlood", "bus_flooded", 0, nothing, flood, nothing},
      {"NoRoomToSend", "bus_flooded", 0, nothing, [](CanRig& rig) { rig.wire.full = true; },
       [](CanRig& rig) { rig.wire.full = false; }},
      {"DelayedFeedback", "feedback_late", 1, delayFeedback, nothing, passAll},
      {"ReorderedFeedback", "feedback_late", 3, reorderFeedback, nothing, passAll},
      {"CablePulled", "bus_down", 0, [](CanRig& rig) { rig.wire.down = true; }, nothing,
       [](CanRig& rig) { rig.wire.down = false; }},
  };
  return cases;
}

class CanFaults : public ::testing::TestWithParam<std::size_t> {};

TEST_P(CanFaults, DuringAMotionLeadsToTheSafeStopWithItsCauseAndCanBeReset) {
  const FaultCase& fault = faultCases()[GetParam()];
  CanRig rig;
  const control::Answer started = rig.play();
  ASSERT_TRUE(started.ok) << started.sentence;
  ASSERT_EQ(rig.system.state(), control::MachineState::Playing) << rig.system.status().fault_sentence;
  const double before = rig.plant.simulation().lengths().minCoeff();

  fault.begin(rig);
  for (int i = 0; i < 1000; ++i) {
    fault.each_cycle(rig);
    rig.system.step();
  }
  const control::ControlStatus status = rig.system.status();
  EXPECT_EQ(status.state, control::MachineState::Faulted);
  EXPECT_EQ(status.fault_name, fault.fault) << status.fault_sentence;
  EXPECT_EQ(status.fault_axis, fault.axis) << status.fault_sentence;
  EXPECT_EQ(rig.brakesEngaged(), kAll);
  EXPECT_EQ(rig.drivesEnabled(), 0u);
  const double sunk = before - rig.plant.simulation().lengths().minCoeff();
  RecordProperty("sunk_um", static_cast<int>(sunk * 1e6));
  EXPECT_LT(sunk, 0.005) << "the platform fell";

  fault.end(rig);
  rig.system.run(0.5);
  const control::Answer reset = rig.system.resetFaults();
  ASSERT_TRUE(reset.ok) << reset.sentence;
  const control::Answer enabled = rig.system.enable();
  EXPECT_TRUE(enabled.ok) << enabled.sentence;
  rig.system.run(0.5);
  EXPECT_EQ(rig.system.state(), control::MachineState::Holding) << rig.system.status().fault_sentence;
}

INSTANTIATE_TEST_SUITE_P(Campaign, CanFaults, ::testing::Range<std::size_t>(0, faultCases().size()),
                         [](const auto& info) { return std::string(faultCases()[info.param].name); });

/// Of the faults after which a drive gives no force: nothing is gained by slowing down along the path.
TEST(CanSystem, ADriveWithoutPowerBringsTheBrakesAtOnce) {
  for (const char* name : {"NodeLost", "DriveFault", "DriveDisabledByItself"}) {
    const auto is_named = [&](const FaultCase& one) { return std::string(one.name) == name; };
    const FaultCase& fault = *std::find_if(faultCases().begin(), faultCases().end(), is_named);
    CanRig rig;
    ASSERT_TRUE(rig.play().ok);
    fault.begin(rig);
    int cycles = 0;
    while (rig.system.state() == control::MachineState::Playing && ++cycles < 200)
      rig.system.step();
    rig.system.run(0.04);  // brakes take 30 ms
    EXPECT_EQ(rig.brakesEngaged(), kAll) << name << ": slows down along the path first";
  }
}

TEST(CanSystem, ADriveThatHasRestartedAndRunsAgainByItselfIsUsedByNobodyBeforeTheControllerIsStartedAnew) {
  CanRig rig;
  ASSERT_TRUE(rig.play(0.04).ok);
  const std::int32_t before = rig.bus.drive(1).position();
  bool is_back = false;
  rig.wire.passes_to_controller = [&](can::Frame& frame) {
    if (frame.id != can::kTransmitPdoBase + 2) return true;
    const auto position = static_cast<std::int32_t>(can::unsignedAt(frame, 2, 4)) - before;  // it counts from zero
    can::putUnsigned(frame, 2, 4, static_cast<std::uint32_t>(position));
    return is_back;
  };
  rig.wire.inject(can::heartbeatFrame(2, can::NmtState::BootUp));
  rig.system.run(1.0);
  EXPECT_EQ(rig.system.status().fault_name, "drive_lost");
  EXPECT_EQ(rig.brakesEngaged(), kAll);
  is_back = true;
  rig.system.run(0.5);
  const control::Answer reset = rig.system.resetFaults();
  EXPECT_FALSE(reset.ok) << "it stands elsewhere than its counts say by " << before << " counts";
  EXPECT_EQ(rig.system.state(), control::MachineState::Faulted);
}

TEST(CanSystem, AnEmergencyStopIsTheCauseAndNotWhatTheDrivesSayAboutIt) {
  CanRig rig;
  ASSERT_TRUE(rig.play().ok);
  rig.image.surroundings.emergency_stop_pressed.store(1);
  rig.system.run(0.01);
  rig.plant.drive(0).fail(0x3220);
  rig.system.run(2.0);
  EXPECT_EQ(rig.system.status().fault_name, "emergency_stop");
  EXPECT_EQ(rig.brakesEngaged(), kAll);
}

TEST(CanSystem, AControllerThatFallsSilentLeavesDrivesThatStopByThemselves) {
  CanRig rig;
  ASSERT_TRUE(rig.play().ok);
  rig.wire.advance(300'000'000);  // nobody writes
  for (std::size_t axis = 0; axis < 4; ++axis)
    EXPECT_NE(rig.plant.drive(axis).state(), can::DriveState::OperationEnabled);
  EXPECT_EQ(rig.brakesEngaged(), kAll);
  EXPECT_EQ(rig.drivesEnabled(), 0u);
}

TEST(CanSystem, RefusesADeploymentWhosePeriodIsNotTheBus) {
  CanRig rig;
  const std::string said = refusalOf([&] {
    control::ControlSystem other(rig.robot, rig.hardware, CanRig::file("config/deployment/simulation.yaml"), rig.bus,
                                 CanRig::stepped());
  });
  EXPECT_NE(said.find("has period_s 0.001"), std::string::npos) << said;
}

TEST(CanSystem, DoesNotStartWithAnotherDriveOrARefusedObjectAndSaysWhich) {
  CanRig wrong;
  wrong.plant.drive(2).dictionary().set(can::objects::kProduct, 7);
  control::Answer answer = wrong.system.start();
  EXPECT_FALSE(answer.ok);
  EXPECT_NE(answer.sentence.find("node 3: wrong identity: product 7 instead of 1615855616"), std::string::npos)
      << answer.sentence;

  CanRig refusing;
  refusing.plant.drive(1).refuseObject(can::objects::kAbortConnection, can::kSdoOutOfRange);
  answer = refusing.system.start();
  EXPECT_FALSE(answer.ok);
  EXPECT_NE(answer.sentence.find("node 2, object 6007:00: value out of range (0x6090030)"), std::string::npos)
      << answer.sentence;
  for (std::size_t axis = 0; axis < 4; ++axis)
    EXPECT_NE(refusing.plant.drive(axis).state(), can::DriveState::OperationEnabled);
}

}  // namespace
}  // namespace knee_robot::fake
