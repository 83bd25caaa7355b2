// CANopen and CiA 402 pieces, each alone: frames, service data, PDO mapping, state machine, bus load, units.
#include <gtest/gtest.h>

#include "knee_robot/base/errors.h"
#include "src/hardware/can/bus_load.h"
#include "src/hardware/can/drive_setup.h"
#include "test/hardware/can_bench.h"
#include "test/refusal.h"

namespace knee_robot::hardware::can {
namespace {

TEST(CanopenFrames, ReadBackWhatTheyWrite) {
  const auto order = parseNmt(nmtFrame(NmtCommand::ResetCommunication, 3));
  ASSERT_TRUE(order);
  EXPECT_EQ(order->command, NmtCommand::ResetCommunication);
  EXPECT_EQ(order->node, 3);
  const auto beat = parseHeartbeat(heartbeatFrame(126, NmtState::Operational));
  ASSERT_TRUE(beat);
  EXPECT_EQ(beat->node, 126);
  EXPECT_EQ(beat->state, NmtState::Operational);
  const auto emergency = parseEmergency(emergencyFrame({4, 0x2310, 3}));
  ASSERT_TRUE(emergency);
  EXPECT_EQ(emergency->node, 4);
  EXPECT_EQ(emergency->code, 0x2310);
  EXPECT_STREQ(emergencyText(emergency->code), "over-current");
  EXPECT_TRUE(isSync(syncFrame()));
  EXPECT_FALSE(parseEmergency(syncFrame())) << "SYNC and emergencies share a base identifier";
}

/// The examples of CiA 301 and of every introduction to it: 4 bytes read from 1018:01 of node 5.
TEST(Sdo, HasTheStandardsBytes) {
  Frame frame = requestFrame(5, {false, objects::kVendor, 0, 0});
  EXPECT_EQ(frame.id, 0x605u);
  EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}));
  frame = requestFrame(5, {true, objects::kProducerHeartbeat, 2, 1000});
  EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0}));
  SdoAnswer answer;
  answer.object = objects::kVendor;
  answer.size = 4;
  answer.value = 0xFB;
  frame = answerFrame(5, answer);
  EXPECT_EQ(frame.id, 0x585u);
  EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0x43, 0x18, 0x10, 0x01, 0xFB, 0, 0, 0}));
  answer.abort = kSdoNoObject;
  frame = answerFrame(5, answer);
  EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0x80, 0x18, 0x10, 0x01, 0x00, 0x00, 0x02, 0x06}));
  EXPECT_EQ(parseAnswer(frame, 5)->abort, kSdoNoObject);
  EXPECT_FALSE(parseAnswer(frame, 6));
}

class SdoBench : public ::testing::Test {
 protected:
  SdoClient client() { return {port, 2, 50'000'000}; }
  std::string refusalOf(const std::function<void(SdoClient&)>& action) {
    SdoClient drive = client();
    try {
      action(drive);
    } catch (const SdoError& error) {
      return error.what();
    }
    return "";
  }
  CanBench bench;
  BenchBus::Port& port = bench.wire.addPort({{kSdoAnswerBase + 2, 0x7FF}});
};

TEST_F(SdoBench, ReadsAndWritesWithSign) {
  SdoClient drive = client();
  EXPECT_EQ(drive.read<std::uint32_t>(objects::kVendor), 0xFBu);
  EXPECT_EQ(drive.read<std::int8_t>(objects::kPeriodExponent), -3);
  drive.writeChecked<std::int16_t>(objects::kTargetTorque, -77);
  EXPECT_EQ(drive.read<std::int16_t>(objects::kTargetTorque), -77);
}

TEST_F(SdoBench, SaysWhatTheDriveRefused) {
  EXPECT_EQ(refusalOf([](SdoClient& d) { d.read<std::uint16_t>(objects::object(0x6072)); }),
            "node 2, object 6072:00: object does not exist (0x6020000)");
  EXPECT_EQ(refusalOf([](SdoClient& d) { d.write<std::uint16_t>(objects::kStatusWord, 1); }),
            "node 2, object 6041:00: attempt to write a read-only object (0x6010002)");
  EXPECT_EQ(refusalOf([](SdoClient& d) { d.write<std::uint32_t>(objects::kTargetTorque, 1); }),
            "node 2, object 6071:00: length does not match the object's type (0x6070010)");
  EXPECT_EQ(refusalOf([](SdoClient& d) { d.read<std::uint8_t>(objects::kStatusWord); }),
            "node 2, object 6041:00: 2 bytes instead of 1");
  bench.drive(1).setSilent(true);
  EXPECT_EQ(refusalOf([](SdoClient& d) { d.read<std::uint16_t>(objects::kStatusWord); }),
            "node 2, object 6041:00: no answer: node without power, other node number or bit rate");
  bench.wire.down = true;
  EXPECT_EQ(refusalOf([](SdoClient& d) { d.read<std::uint16_t>(objects::kStatusWord); }),
            "node 2, object 6041:00: the bus takes no frame: is it up?");
}

TEST_F(SdoBench, NamesEveryAbortCodeThatTheSimulatedDriveUses) {
  for (const std::uint32_t code :
       {kSdoTimeout, kSdoUnsupported, kSdoReadOnly, kSdoWriteOnly, kSdoNoObject, kSdoNotMappable, kSdoPdoTooLong,
        kSdoWrongSize, kSdoNoSubindex, kSdoOutOfRange, kSdoWrongState})
    EXPECT_STRNE(abortText(code), "unknown abort code") << std::hex << code;
  EXPECT_STREQ(abortText(0x12345678), "unknown abort code");
}

TEST_F(SdoBench, TakesNoAnswerToAnotherQuestion) {
  SdoAnswer stale;
  stale.object = objects::kStatusWord;
  stale.size = 2;
  stale.value = 0x1234;
  bool sent = false;
  bench.wire.before_receive = [&] {
    if (sent) return;
    sent = true;
    Frame frame = answerFrame(2, stale);
    port.queue.push_back(frame);
    stale.object = objects::kVendor;  // and one of another size for the right object comes too late
  };
  SdoClient drive = client();
  EXPECT_EQ(drive.read<std::uint32_t>(objects::kVendor), 0xFBu);
}

TEST_F(SdoBench, MapsAPdoAndReadsItBack) {
  SdoClient drive = client();
  configure(drive, feedbackPdo(2));
  EXPECT_EQ(feedbackPdo(2).bytes(), 8);
  EXPECT_EQ(drive.read<std::uint32_t>(objects::object(0x1A00, 2)), 0x60640020u);
  EXPECT_EQ(drive.read<std::uint8_t>(objects::object(0x1800, 2)), 1);
  EXPECT_EQ(drive.read<std::uint16_t>(objects::object(0x1800, 3)), 0);
  configure(drive, feedbackPdo(2));  // again, over itself
  Pdo wrong = commandPdo(2);
  wrong.objects.push_back({objects::kVendor, 32});
  EXPECT_NE(refusalOf([&](SdoClient& d) { configure(d, wrong); }).find("object cannot be mapped"), std::string::npos);
}

TEST_F(SdoBench, DriveRefusesToChangeAPdoInUse) {
  SdoClient drive = client();
  configure(drive, commandPdo(2));
  EXPECT_NE(refusalOf([](SdoClient& d) { d.write<std::uint8_t>(objects::object(0x1600, 0), 0); }).find("device state"),
            std::string::npos);
}

TEST(DriveStates, AreReadByTheirMasks) {
  EXPECT_EQ(stateOf(0x0250), DriveState::SwitchOnDisabled);
  EXPECT_EQ(stateOf(0x0231), DriveState::ReadyToSwitchOn);
  EXPECT_EQ(stateOf(0x0233), DriveState::SwitchedOn);
  EXPECT_EQ(stateOf(0x1637), DriveState::OperationEnabled);
  EXPECT_EQ(stateOf(0x0217), DriveState::QuickStopActive);
  EXPECT_EQ(stateOf(0x0218), DriveState::Fault);
  EXPECT_EQ(stateOf(0x021F), DriveState::FaultReaction);
  EXPECT_EQ(stateOf(0x0000), DriveState::NotReady);
  int enabled = 0;
  for (int word = 0; word <= 0xFFFF; ++word)
    enabled += stateOf(static_cast<std::uint16_t>(word)) == DriveState::OperationEnabled ? 1 : 0;
  EXPECT_EQ(enabled, 1 << 10) << "six bits decide, ten are free";
}

TEST(DriveStates, NeverEnableFromAnyStateUnlessThatIsTheGoal) {
  for (int i = 0; i <= static_cast<int>(DriveState::Unknown); ++i) {
    const auto state = static_cast<DriveState>(i);
    EXPECT_NE(controlWord(state, DriveGoal::Off) & 0x0F, kEnableOperation) << toText(state);
    EXPECT_NE(controlWord(state, DriveGoal::QuickStop) & 0x0F, kEnableOperation) << toText(state);
  }
  EXPECT_EQ(controlWord(DriveState::OperationEnabled, DriveGoal::QuickStop), kQuickStop);
  EXPECT_EQ(controlWord(DriveState::Fault, DriveGoal::Enabled), kDisableVoltage) << "a fault is reset on request only";
}

TEST(FaultReset, GivesARisingEdgeAndThenGivesUp) {
  FaultReset reset;
  EXPECT_EQ(reset.controlWord(DriveState::Fault, kDisableVoltage), kDisableVoltage);
  reset.request();
  int edges = 0;
  std::uint16_t last = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint16_t word = reset.controlWord(DriveState::Fault, kDisableVoltage);
    edges += (word & kFaultReset) != 0 && (last & kFaultReset) == 0 ? 1 : 0;
    last = word;
  }
  EXPECT_GT(edges, 3);
  EXPECT_FALSE(reset.pending());
  EXPECT_EQ(last, kDisableVoltage);
}

TEST(QuickStop, EndsWithThePowerStageOff) {
  CanBench bench;
  ASSERT_TRUE(bench.bus().selfTest().passed);
  ASSERT_TRUE(bench.energise());
  bench.drive(0).take(requestFrame(1, {true, objects::kControlWord, 2, kQuickStop}));
  EXPECT_EQ(bench.drive(0).state(), DriveState::QuickStopActive);
  EXPECT_EQ(bench.drive(0).torque(), 0);
  bench.wire.advance(50'000'000);
  EXPECT_EQ(bench.drive(0).state(), DriveState::SwitchOnDisabled);
}

/// hardware.md's figures: SYNC + 4 commands of 4 bytes + 4 feedbacks of 8 bytes take 807 to 975 bits.
TEST(BusLoad, AgreesWithTheFiguresByHand) {
  EXPECT_EQ(frameBits(0) + 4 * frameBits(4) + 4 * frameBits(8), 807);
  EXPECT_EQ(longestFrameBits(0) + 4 * longestFrameBits(4) + 4 * longestFrameBits(8), 975);
  CanSettings settings = benchSettings();
  EXPECT_NO_THROW(requireFits(settings, ""));
  EXPECT_LT(busLoad(settings), 0.76);
  settings.period_s = 0.001;
  const std::string said = refusalOf([&] { requireFits(settings, ""); });
  EXPECT_NE(said.find("1000 cycles a second: the cyclic frames take 14"), std::string::npos) << said;
  settings.period_s = 0.002;
  settings.bit_rate = 500e3;
  EXPECT_THROW(CanBench{settings}, InputError);
}

TEST(Units, GoFromForceToTorqueToPerMilleAndBack) {
  const AxisUnits units{56.8, 0.010, 0.188136};
  // 56.8 N at a 10 mm screw: 56.8 * 0.010 / (2 pi) = 0.0904 Nm = 480.5 per mille of 0.188136 Nm.
  EXPECT_NEAR(torqueOf(56.8, 0.010), 0.09040, 1e-5);
  EXPECT_EQ(toPerMille(1.0, units, 5000), 481);
  EXPECT_EQ(toPerMille(-1.0, units, 5000), -481);
  EXPECT_NEAR(voltsOf(481, units), 1.0, 0.5 / 480.5);
  EXPECT_EQ(toPerMille(9.0, units, 3000), 3000) << "the drive's current limit";
  EXPECT_EQ(toPerMille(1e300, units, 100000), 4805) << "10 V";
  EXPECT_EQ(torqueLimitPerMille({1, std::nullopt, 0.188136, 3.12, 4.68}), 1500);
}

TEST(Settings, RefuseAWrongSelfTestByTheLimitInTheDrive) {
  CanBench bench;
  bench.drive(3).dictionary().set(objects::kCurrentLimit, 20000);
  const SelfTest test = bench.bus().selfTest();
  EXPECT_FALSE(test.passed);
  EXPECT_EQ(test.findings.back(),
            "axis 4: node 4: current limit in A (3001:02) is 20 in the drive and 15 in the hardware file; mend the "
            "wrong one.");
  EXPECT_NE(bench.drive(3).nmt(), NmtState::Operational);
}

TEST(SelfTest, StopsADriveThatACrashLeftEnabledAndResetsOneInFault) {
  CanBench bench;
  ASSERT_TRUE(bench.bus().selfTest().passed);
  ASSERT_TRUE(bench.energise());
  bench.cycle({1, 1, 1, 1});
  bench.drive(2).fail(0x2310);
  ASSERT_EQ(bench.drive(0).state(), DriveState::OperationEnabled);
  const SelfTest again = bench.bus().selfTest();
  ASSERT_TRUE(again.passed) << again.findings.back();
  for (std::size_t axis = 0; axis < 4; ++axis) {
    EXPECT_EQ(bench.drive(axis).state(), DriveState::SwitchOnDisabled);
    EXPECT_EQ(bench.drive(axis).dictionary().get(objects::kTargetTorque), 0);
  }
}

}  // namespace
}  // namespace knee_robot::hardware::can
