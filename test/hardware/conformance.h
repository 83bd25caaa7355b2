#pragma once

// What every backend must do, whatever drives are behind it: ranges, quantization, simultaneity, wrap, disconnection,
// late answers, error codes, NaN refused at the border. A backend's test defines a ConformanceBench, includes this
// header in one test program, and instantiates the suite:
//
//     INSTANTIATE_TEST_SUITE_P(Mine, AxisBusConformance,
//                              ::testing::Values(Backend{"mine", [] { return std::make_unique<MyBench>(); }}),
//                              backendName);

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/hardware/axis_bus.h"

namespace knee_robot::hardware {

using Volts = std::array<double, kAxes>;

/// A bus with its device, and what the suite needs to see and to do at the device's far side.
class ConformanceBench {
 public:
  virtual ~ConformanceBench() = default;
  virtual AxisBus& bus() = 0;
  virtual double lowestVolts() const = 0;
  virtual double highestVolts() const = 0;
  /// Largest distance between two neighbouring set values, V.
  virtual double voltStep() const = 0;
  /// What the four motors get now, V.
  virtual Volts terminalVolts() const = 0;
  /// Digital outputs as the relays see them, bits 0 to 3.
  virtual std::uint8_t terminalOutputs() const = 0;
  virtual void setInputs(std::uint8_t bits) = 0;
  /// Turns all four encoders on by these counts.
  virtual void move(std::uint32_t counts) = 0;
  /// While set, all four encoders turn on by one count between any two accesses to the device.
  virtual void keepMoving(bool on) = 0;
  /// Set values of all four motors at every moment at which the device could be looked at.
  virtual std::vector<Volts>& seenOutputs() = 0;
  virtual void disconnect() = 0;
  virtual void reconnect() = 0;
  /// While set, the device's answers come after their time. False: not possible with this device.
  virtual bool answerLate(bool /*on*/) { return false; }
  /// Switches drives on that give no force before. False: it failed.
  virtual bool energise() { return true; }
  /// Lets what was asked or moved take effect, where the device needs cycles for that.
  virtual void settle() {}
};

struct Backend {
  std::string name;
  std::function<std::unique_ptr<ConformanceBench>()> make;
};

inline std::string backendName(const ::testing::TestParamInfo<Backend>& info) {
  return info.param.name;
}

class AxisBusConformance : public ::testing::TestWithParam<Backend> {
 protected:
  void ready() {
    const SelfTest result = bus().selfTest();
    ASSERT_TRUE(result.passed) << (result.findings.empty() ? "no finding" : result.findings.back());
  }
  void energised() {
    ready();
    ASSERT_TRUE(bench().energise());
  }
  AxisBus& bus() { return bench_->bus(); }
  ConformanceBench& bench() { return *bench_; }

 private:
  std::unique_ptr<ConformanceBench> bench_ = GetParam().make();
};

TEST_P(AxisBusConformance, RefusesOutputsBeforeTheSelfTest) {
  Volts written{};
  written.fill(123.0);
  EXPECT_EQ(bus().writeVolts({1, 1, 1, 1}, written), IoStatus::NotReady);
  EXPECT_EQ(bus().writeOutputs(1), IoStatus::NotReady);
  EXPECT_EQ(written[0], 123.0);
  EXPECT_EQ(bench().terminalOutputs(), 0);
}

TEST_P(AxisBusConformance, StartsWithDrivesDisabledZeroVoltsAndCountsAtZero) {
  bench().move(123456);
  ready();
  bench().settle();
  EXPECT_EQ(bench().terminalVolts(), (Volts{0, 0, 0, 0}));
  EXPECT_EQ(bench().terminalOutputs(), 0);
  AxisFeedback feedback;
  ASSERT_EQ(bus().read(feedback), IoStatus::Ok);
  for (const std::int32_t count : feedback.counts)
    EXPECT_EQ(count, 0);
}

TEST_P(AxisBusConformance, ASecondSelfTestSilencesOutputsThatACrashLeft) {
  energised();
  Volts written{};
  ASSERT_EQ(bus().writeVolts({5, -5, 5, -5}, written), IoStatus::Ok);
  ASSERT_EQ(bus().writeOutputs(0x0F), IoStatus::Ok);
  ready();
  EXPECT_EQ(bench().terminalVolts(), (Volts{0, 0, 0, 0}));
  EXPECT_EQ(bench().terminalOutputs(), 0);
}

TEST_P(AxisBusConformance, WritesWhatItSaysWithinHalfAStep) {
  energised();
  const double reach = 0.999 * std::min(-bench().lowestVolts(), bench().highestVolts());
  for (double volts = -reach; volts < reach; volts += 0.000371 * reach) {
    const Volts asked{volts, -volts, volts / 3, 0.01 * reach};
    Volts written{};
    ASSERT_EQ(bus().writeVolts(asked, written), IoStatus::Ok);
    bench().settle();
    ASSERT_EQ(bench().terminalVolts(), written);
    for (std::size_t axis = 0; axis < asked.size(); ++axis) {
      ASSERT_LE(std::abs(written[axis] - asked[axis]), bench().voltStep() / 2 + 1e-12) << asked[axis];
    }
  }
}

TEST_P(AxisBusConformance, ClampsToTheRangeAndSaysSo) {
  energised();
  Volts written{};
  ASSERT_EQ(bus().writeVolts({1e300, -1e300, 10.0, -10.0}, written), IoStatus::Ok);
  bench().settle();
  const double high = bench().highestVolts();
  const double low = bench().lowestVolts();
  EXPECT_EQ(written, (Volts{high, low, high, low}));
  EXPECT_EQ(bench().terminalVolts(), written);
}

TEST_P(AxisBusConformance, RefusesACommandThatIsNotFiniteAsAWhole) {
  energised();
  Volts before{};
  ASSERT_EQ(bus().writeVolts({1, 2, 3, 4}, before), IoStatus::Ok);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), infinity, -infinity}) {
    for (std::size_t axis = 0; axis < 4; ++axis) {
      Volts command{7, 7, 7, 7};
      command[axis] = bad;
      Volts written{};
      written.fill(99.0);
      EXPECT_EQ(bus().writeVolts(command, written), IoStatus::NotFinite);
      EXPECT_EQ(written, (Volts{99, 99, 99, 99}));
      EXPECT_EQ(bench().terminalVolts(), before);
    }
  }
}

TEST_P(AxisBusConformance, MovesTheFourOutputsAtOneInstant) {
  energised();
  Volts first{};
  Volts second{};
  ASSERT_EQ(bus().writeVolts({-9, -3, 3, 9}, first), IoStatus::Ok);
  bench().seenOutputs().clear();
  ASSERT_EQ(bus().writeVolts({8, 2, -2, -8}, second), IoStatus::Ok);
  ASSERT_FALSE(bench().seenOutputs().empty());
  for (const Volts& seen : bench().seenOutputs())
    EXPECT_TRUE(seen == first || seen == second);
  EXPECT_EQ(bench().seenOutputs().back(), second);
}

TEST_P(AxisBusConformance, ReadsTheFourCountsOfOneInstant) {
  ready();
  bench().keepMoving(true);
  for (int repeat = 0; repeat < 100; ++repeat) {
    AxisFeedback feedback;
    ASSERT_EQ(bus().read(feedback), IoStatus::Ok);
    for (const std::int32_t count : feedback.counts)
      ASSERT_EQ(count, feedback.counts[0]);
  }
}

TEST_P(AxisBusConformance, CountsAcrossTheWrapOfInt32InBothDirections) {
  ready();
  AxisFeedback last;
  ASSERT_EQ(bus().read(last), IoStatus::Ok);
  for (const std::uint32_t step : {1000000007u, static_cast<std::uint32_t>(-1000000007)}) {
    for (int repeat = 0; repeat < 7; ++repeat) {
      bench().move(step);
      bench().settle();
      AxisFeedback now;
      ASSERT_EQ(bus().read(now), IoStatus::Ok);
      for (std::size_t axis = 0; axis < 4; ++axis) {
        ASSERT_EQ(countDifference(now.counts[axis], last.counts[axis]), static_cast<std::int32_t>(step));
      }
      last = now;
    }
  }
}

TEST_P(AxisBusConformance, PassesDigitalLinesBothWays) {
  ready();
  for (std::uint8_t bits = 0; bits < 16; ++bits) {
    ASSERT_EQ(bus().writeOutputs(bits), IoStatus::Ok);
    bench().settle();
    EXPECT_EQ(bench().terminalOutputs(), bits);
    bench().setInputs(bits);
    bench().settle();
    AxisFeedback feedback;
    ASSERT_EQ(bus().read(feedback), IoStatus::Ok);
    EXPECT_EQ(feedback.digital_inputs, bits);
  }
  ASSERT_EQ(bus().writeOutputs(0x05), IoStatus::Ok);
  EXPECT_EQ(bus().writeOutputs(0x10), IoStatus::OutOfRange);
  EXPECT_EQ(bench().terminalOutputs(), 0x05);
}

TEST_P(AxisBusConformance, ReportsADisconnectAtEveryCallAndTouchesNothing) {
  energised();
  Volts before{};
  ASSERT_EQ(bus().writeVolts({1, 2, 3, 4}, before), IoStatus::Ok);
  bench().disconnect();
  AxisFeedback feedback;
  feedback.counts.fill(77);
  EXPECT_EQ(bus().read(feedback), IoStatus::Disconnected);
  EXPECT_EQ(feedback.counts[3], 77);
  Volts written{};
  written.fill(99.0);
  EXPECT_EQ(bus().writeVolts({0, 0, 0, 0}, written), IoStatus::Disconnected);
  EXPECT_EQ(written[0], 99.0);
  EXPECT_EQ(bus().writeOutputs(0), IoStatus::Disconnected);
  EXPECT_EQ(bench().terminalVolts(), before);  // outputs hold: that is why a holding brake is needed
  EXPECT_FALSE(bus().selfTest().passed);
  EXPECT_EQ(bus().writeVolts({0, 0, 0, 0}, written), IoStatus::NotReady);
  bench().reconnect();
  EXPECT_TRUE(bus().selfTest().passed);
}

TEST_P(AxisBusConformance, RefusesAnAnswerThatComesTooLateAndGoesOnWhenTheDeviceDoes) {
  ready();
  AxisFeedback feedback;
  ASSERT_EQ(bus().read(feedback), IoStatus::Ok);
  if (!bench().answerLate(true)) GTEST_SKIP() << "this device answers within the access itself";
  feedback.counts.fill(77);
  EXPECT_NE(bus().read(feedback), IoStatus::Ok);
  EXPECT_EQ(feedback.counts[0], 77) << "an old count is not a new one";
  bench().answerLate(false);
  bench().settle();
  EXPECT_EQ(bus().read(feedback), IoStatus::Ok);
  EXPECT_NE(feedback.counts[0], 77);
}

TEST_P(AxisBusConformance, AnswersNotReadyAgainAfterASelfTestThatFailed) {
  ready();
  bench().disconnect();
  EXPECT_FALSE(bus().selfTest().passed);
  bench().reconnect();
  Volts written{};
  EXPECT_EQ(bus().writeVolts({1, 1, 1, 1}, written), IoStatus::NotReady) << "back, but nobody has looked at it";
  EXPECT_EQ(bus().writeOutputs(1), IoStatus::NotReady);
  ready();
  EXPECT_EQ(bus().writeVolts({1, 1, 1, 1}, written), IoStatus::Ok);
}

TEST_P(AxisBusConformance, SaysWhatItDidInItsSelfTest) {
  const SelfTest result = bus().selfTest();
  ASSERT_TRUE(result.passed);
  EXPECT_FALSE(result.findings.empty());
  for (const std::string& finding : result.findings)
    EXPECT_GT(finding.size(), 10u);
}

}  // namespace knee_robot::hardware
