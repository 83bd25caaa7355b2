// What every backend must do, whatever drives are behind it. A new backend adds a bench like CardBench and a line to Backends.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test/hardware/card_bench.h"

namespace knee_robot::hardware {
namespace {

using Volts = std::array<double, kAxes>;

template <typename Backend>
class AxisBusConformance : public ::testing::Test {
 protected:
  void ready() {
    const SelfTest result = bus().selfTest();
    ASSERT_TRUE(result.passed) << (result.findings.empty() ? "no finding" : result.findings.back());
  }
  AxisBus& bus() { return backend_.bench.bus(); }
  auto& bench() { return backend_.bench; }
  Backend backend_;
};

using Backends = ::testing::Types<HeapCards, SharedCards>;
TYPED_TEST_SUITE(AxisBusConformance, Backends);

TYPED_TEST(AxisBusConformance, RefusesOutputsBeforeTheSelfTest) {
  Volts written{};
  written.fill(123.0);
  EXPECT_EQ(this->bus().writeVolts({1, 1, 1, 1}, written), IoStatus::NotReady);
  EXPECT_EQ(this->bus().writeOutputs(1), IoStatus::NotReady);
  EXPECT_EQ(written[0], 123.0);
  EXPECT_EQ(this->bench().terminalOutputs(), 0);
}

TYPED_TEST(AxisBusConformance, StartsWithDrivesDisabledZeroVoltsAndCountsAtZero) {
  this->bench().move(123456);
  this->ready();
  EXPECT_EQ(this->bench().terminalVolts(), (Volts{0, 0, 0, 0}));
  EXPECT_EQ(this->bench().terminalOutputs(), 0);
  AxisFeedback feedback;
  ASSERT_EQ(this->bus().read(feedback), IoStatus::Ok);
  for (const std::int32_t count : feedback.counts)
    EXPECT_EQ(count, 0);
}

TYPED_TEST(AxisBusConformance, ASecondSelfTestSilencesOutputsThatACrashLeft) {
  this->ready();
  Volts written{};
  ASSERT_EQ(this->bus().writeVolts({5, -5, 5, -5}, written), IoStatus::Ok);
  ASSERT_EQ(this->bus().writeOutputs(0x0F), IoStatus::Ok);
  this->ready();
  EXPECT_EQ(this->bench().terminalVolts(), (Volts{0, 0, 0, 0}));
  EXPECT_EQ(this->bench().terminalOutputs(), 0);
}

TYPED_TEST(AxisBusConformance, WritesWhatItSaysWithinHalfAStep) {
  this->ready();
  for (double volts = -9.99; volts < 9.99; volts += 0.0037) {
    const Volts asked{volts, -volts, volts / 3, 0.1};
    Volts written{};
    ASSERT_EQ(this->bus().writeVolts(asked, written), IoStatus::Ok);
    ASSERT_EQ(this->bench().terminalVolts(), written);
    for (std::size_t axis = 0; axis < asked.size(); ++axis) {
      ASSERT_LE(std::abs(written[axis] - asked[axis]), this->bench().voltStep() / 2 + 1e-12) << asked[axis];
    }
  }
}

TYPED_TEST(AxisBusConformance, ClampsToTheRangeAndSaysSo) {
  this->ready();
  Volts written{};
  ASSERT_EQ(this->bus().writeVolts({1e300, -1e300, 10.0, -10.0}, written), IoStatus::Ok);
  const double high = this->bench().highestVolts();
  const double low = this->bench().lowestVolts();
  EXPECT_EQ(written, (Volts{high, low, high, low}));
  EXPECT_EQ(this->bench().terminalVolts(), written);
}

TYPED_TEST(AxisBusConformance, RefusesACommandThatIsNotFiniteAsAWhole) {
  this->ready();
  Volts before{};
  ASSERT_EQ(this->bus().writeVolts({1, 2, 3, 4}, before), IoStatus::Ok);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), infinity, -infinity}) {
    for (std::size_t axis = 0; axis < 4; ++axis) {
      Volts command{7, 7, 7, 7};
      command[axis] = bad;
      Volts written{};
      written.fill(99.0);
      EXPECT_EQ(this->bus().writeVolts(command, written), IoStatus::NotFinite);
      EXPECT_EQ(written, (Volts{99, 99, 99, 99}));
      EXPECT_EQ(this->bench().terminalVolts(), before);
    }
  }
}

TYPED_TEST(AxisBusConformance, MovesTheFourOutputsAtOneInstant) {
  this->ready();
  Volts first{};
  Volts second{};
  ASSERT_EQ(this->bus().writeVolts({-9, -3, 3, 9}, first), IoStatus::Ok);
  this->bench().seenOutputs().clear();
  ASSERT_EQ(this->bus().writeVolts({8, 2, -2, -8}, second), IoStatus::Ok);
  ASSERT_FALSE(this->bench().seenOutputs().empty());
  for (const Volts& seen : this->bench().seenOutputs())
    EXPECT_TRUE(seen == first || seen == second);
  EXPECT_EQ(this->bench().seenOutputs().back(), second);
}

TYPED_TEST(AxisBusConformance, ReadsTheFourCountsOfOneInstant) {
  this->ready();
  this->bench().keepMoving(true);
  for (int repeat = 0; repeat < 100; ++repeat) {
    AxisFeedback feedback;
    ASSERT_EQ(this->bus().read(feedback), IoStatus::Ok);
    for (const std::int32_t count : feedback.counts)
      ASSERT_EQ(count, feedback.counts[0]);
  }
}

TYPED_TEST(AxisBusConformance, CountsAcrossTheWrapOfInt32InBothDirections) {
  this->ready();
  AxisFeedback last;
  ASSERT_EQ(this->bus().read(last), IoStatus::Ok);
  for (const std::uint32_t step : {1000000007u, static_cast<std::uint32_t>(-1000000007)}) {
    for (int repeat = 0; repeat < 7; ++repeat) {
      this->bench().move(step);
      AxisFeedback now;
      ASSERT_EQ(this->bus().read(now), IoStatus::Ok);
      for (std::size_t axis = 0; axis < 4; ++axis) {
        ASSERT_EQ(countDifference(now.counts[axis], last.counts[axis]), static_cast<std::int32_t>(step));
      }
      last = now;
    }
  }
}

TYPED_TEST(AxisBusConformance, PassesDigitalLinesBothWays) {
  this->ready();
  for (std::uint8_t bits = 0; bits < 16; ++bits) {
    ASSERT_EQ(this->bus().writeOutputs(bits), IoStatus::Ok);
    EXPECT_EQ(this->bench().terminalOutputs(), bits);
    this->bench().setInputs(bits);
    AxisFeedback feedback;
    ASSERT_EQ(this->bus().read(feedback), IoStatus::Ok);
    EXPECT_EQ(feedback.digital_inputs, bits);
  }
  ASSERT_EQ(this->bus().writeOutputs(0x05), IoStatus::Ok);
  EXPECT_EQ(this->bus().writeOutputs(0x10), IoStatus::OutOfRange);
  EXPECT_EQ(this->bench().terminalOutputs(), 0x05);
}

TYPED_TEST(AxisBusConformance, ReportsADisconnectAtEveryCallAndTouchesNothing) {
  this->ready();
  Volts before{};
  ASSERT_EQ(this->bus().writeVolts({1, 2, 3, 4}, before), IoStatus::Ok);
  this->bench().disconnect();
  AxisFeedback feedback;
  feedback.counts.fill(77);
  EXPECT_EQ(this->bus().read(feedback), IoStatus::Disconnected);
  EXPECT_EQ(feedback.counts[3], 77);
  Volts written{};
  written.fill(99.0);
  EXPECT_EQ(this->bus().writeVolts({0, 0, 0, 0}, written), IoStatus::Disconnected);
  EXPECT_EQ(written[0], 99.0);
  EXPECT_EQ(this->bus().writeOutputs(0), IoStatus::Disconnected);
  EXPECT_EQ(this->bench().terminalVolts(), before);  // outputs hold: that is why a hold device is needed
  EXPECT_FALSE(this->bus().selfTest().passed);
  EXPECT_EQ(this->bus().writeVolts({0, 0, 0, 0}, written), IoStatus::NotReady);
  this->bench().reconnect();
  EXPECT_TRUE(this->bus().selfTest().passed);
}

}  // namespace
}  // namespace knee_robot::hardware
