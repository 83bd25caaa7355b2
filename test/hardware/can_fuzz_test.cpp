// Any bytes may come over a bus: every parser, the drive model and the running bus take them without harm.
// Deterministic.
#include <gtest/gtest.h>
#include <linux/can.h>

#include <cmath>
#include <random>

#include "src/hardware/can/bus_errors.h"
#include "test/hardware/can_bench.h"

namespace knee_robot::hardware::can {
namespace {

constexpr int kRounds = 300000;

/// Half of them quite random, half near the identifiers in use.
Frame randomFrame(std::mt19937& random) {
  static const std::uint32_t kIds[] = {0x000, 0x080, 0x081, 0x084, 0x181, 0x184, 0x281,
                                       0x201, 0x301, 0x581, 0x601, 0x604, 0x701, 0x77E};
  Frame frame;
  const std::uint32_t bits = random();
  frame.id = (bits & 1) != 0 ? kIds[random() % std::size(kIds)] : random() & 0x1FFFFFFF;
  frame.extended = frame.id > 0x7FF || (bits & 0xF0) == 0;
  frame.remote = (bits & 0xF00) == 0;
  frame.error = (bits & 0xF000) == 0;
  frame.length = static_cast<std::uint8_t>((bits >> 16 & 3) != 0 ? 8 : random() % 9);
  for (std::size_t i = 0; i < frame.length; ++i)
    frame.data[i] = static_cast<std::uint8_t>(random());
  if ((bits >> 20 & 1) != 0) {  // an object that exists
    static const objects::Object kObjects[] = {objects::kControlWord,      objects::kMode,
                                               objects::object(0x1400, 1), objects::object(0x1600, 0),
                                               objects::object(0x1600, 1), objects::object(0x1A00, 0),
                                               objects::object(0x1A00, 3)};
    const objects::Object object = kObjects[random() % std::size(kObjects)];
    putUnsigned(frame, 1, 2, objects::indexOf(object));
    frame.data[3] = objects::subindexOf(object);
    if ((bits >> 21 & 1) != 0) frame.data[0] = static_cast<std::uint8_t>(0x22 | (random() & 0x0D));
  }
  return frame;
}

TEST(CanFuzz, ParsersTakeAnyFrame) {
  std::mt19937 random(1);
  long parsed = 0;
  for (int i = 0; i < kRounds; ++i) {
    const Frame frame = randomFrame(random);
    if (const auto order = parseNmt(frame)) {
      ++parsed;
      ASSERT_LE(order->node, kLargestNode);
    }
    if (const auto beat = parseHeartbeat(frame)) {
      ++parsed;
      ASSERT_TRUE(beat->node >= 1 && beat->node <= kLargestNode);
      ASSERT_STRNE(toText(beat->state), "unknown");
    }
    if (const auto emergency = parseEmergency(frame)) {
      ++parsed;
      ASSERT_NE(emergencyText(emergency->code), nullptr);
    }
    if (const auto request = parseRequest(frame, 1)) {
      ++parsed;
      ASSERT_TRUE(request->size >= -1 && request->size <= 4);
    }
    if (const auto answer = parseAnswer(frame, 1)) {
      ++parsed;
      ASSERT_TRUE(answer->size >= 0 && answer->size <= 4);
      ASSERT_NE(abortText(answer->abort), nullptr);
    }
    toText(busErrors(frame));
  }
  EXPECT_GT(parsed, kRounds / 20) << "the frames have to reach the parsers' insides";
}

TEST(CanFuzz, KernelFramesOfAnyBytesAreTakenOrRefused) {
  std::mt19937 random(2);
  for (int i = 0; i < kRounds; ++i) {
    ::can_frame raw{};
    auto* bytes = reinterpret_cast<unsigned char*>(&raw);
    for (std::size_t k = 0; k < sizeof raw; ++k)
      bytes[k] = static_cast<unsigned char>(random());
    if ((random() & 1) != 0) raw.can_dlc &= 0x0F;
    Frame frame;
    if (!fromKernel(raw, frame)) continue;
    ASSERT_LE(frame.length, 8);
    ::can_frame back{};
    toKernel(frame, back);
    Frame again;
    ASSERT_TRUE(fromKernel(back, again));
    ASSERT_EQ(again.id, frame.id);
    ASSERT_EQ(again.data, frame.data);
  }
}

TEST(CanFuzz, TheSimulatedDriveTakesAnyFrame) {
  std::mt19937 random(3);
  CanBench bench;
  ASSERT_TRUE(bench.bus().selfTest().passed);
  for (int i = 0; i < kRounds / 10; ++i) {
    bench.drive(0).take(randomFrame(random));
    bench.drive(0).step(i * 100'000LL);
    ASSERT_LE(std::abs(bench.drive(0).torque()), 4808);
    ASSERT_LE(bench.drive(0).outputs(), 0x0F);
  }
}

TEST(CanFuzz, TheRunningBusStaysWithinBoundsWhateverItHears) {
  std::mt19937 random(4);
  CanBench bench;
  ASSERT_TRUE(bench.bus().selfTest().passed);
  ASSERT_TRUE(bench.energise());
  for (int cycle = 0; cycle < 5000; ++cycle) {
    const int count = static_cast<int>(random() % 20);
    for (int i = 0; i < count; ++i) {
      Frame frame = randomFrame(random);
      bench.wire.inject(frame);
    }
    const IoStatus status = bench.cycle({1.0, -1.0, 5.0, -5.0});
    ASSERT_TRUE(status == IoStatus::Ok || status == IoStatus::Disconnected || status == IoStatus::DeviceError);
    for (const double volts : bench.written)
      ASSERT_TRUE(std::isfinite(volts) && std::abs(volts) <= kLargestVolts);
    ASSERT_LE(bench.bus().failure().axis, kAxes);
  }
}

TEST(CanFuzz, TheSelfTestEndsWhateverTheDrivesAnswer) {
  std::mt19937 random(5);
  for (int round = 0; round < 20; ++round) {
    CanBench bench;
    bench.wire.passes_to_controller = [&](Frame& frame) {
      if (random() % 16 == 0) frame = randomFrame(random);
      return random() % 64 != 0;
    };
    const SelfTest test = bench.bus().selfTest();
    EXPECT_FALSE(test.findings.empty());
    for (std::size_t axis = 0; axis < 4; ++axis)
      EXPECT_NE(bench.drive(axis).state(), DriveState::OperationEnabled);
  }
}

}  // namespace
}  // namespace knee_robot::hardware::can
