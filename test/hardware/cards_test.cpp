// Drivers and models of the two cards against the register tables.
#include <gtest/gtest.h>

#include "knee_robot/hardware/pci1720_registers.h"
#include "knee_robot/hardware/pci1784_registers.h"
#include "test/hardware/card_bench.h"

namespace knee_robot::hardware {
namespace {

TEST(Pci1720, GivesTheVoltagesOfItsFourRanges) {
  EXPECT_DOUBLE_EQ(pci1720::toVolts(0x000, 0), 0.0);
  EXPECT_DOUBLE_EQ(pci1720::toVolts(0x800, 0), 2.5);
  EXPECT_DOUBLE_EQ(pci1720::toVolts(0x800, 1), 5.0);
  EXPECT_DOUBLE_EQ(pci1720::toVolts(0x000, 2), -5.0);
  EXPECT_DOUBLE_EQ(pci1720::toVolts(0x800, 2), 0.0);
  EXPECT_DOUBLE_EQ(pci1720::toVolts(0x000, 3), -10.0);
  EXPECT_DOUBLE_EQ(pci1720::toVolts(0x800, 3), 0.0);
  EXPECT_DOUBLE_EQ(pci1720::toVolts(0xFFF, 3), 10.0 - 20.0 / 4096);
}

TEST(Pci1720, RoundsToTheNearestCodeAndClamps) {
  EXPECT_EQ(Pci1720::codeFor(0.0), 0x800);
  EXPECT_EQ(Pci1720::codeFor(0.004882), 0x801);  // one step is 4.88 mV
  EXPECT_EQ(Pci1720::codeFor(0.0024), 0x800);
  EXPECT_EQ(Pci1720::codeFor(-10.0), 0x000);
  EXPECT_EQ(Pci1720::codeFor(10.0), 0xFFF);
  EXPECT_EQ(Pci1720::codeFor(1e9), 0xFFF);
  EXPECT_EQ(Pci1720::codeFor(-1e9), 0x000);
}

TEST(Pci1720Model, StandsAtZeroVoltsInTheFiveVoltRangeAfterAColdStart) {
  const simulation::Pci1720Image image;
  EXPECT_EQ(simulation::outputVolts(image), (std::array<double, 4>{0, 0, 0, 0}));
}

TEST(Pci1720Model, JumpsToMinusTenVoltsWhenTheRangeIsSetFirst) {
  simulation::Pci1720Image image;
  simulation::Pci1720Model model(image);
  ASSERT_EQ(model.write8(pci1720::kRange, pci1720::kAllBipolar10V), IoStatus::Ok);
  EXPECT_DOUBLE_EQ(simulation::outputVolts(image)[0], -10.0);
}

TEST(Pci1720Model, SetsTheRangeOfEachChannelByTwoBits) {
  simulation::Pci1720Image image;
  simulation::Pci1720Model model(image);
  ASSERT_EQ(model.write8(pci1720::kRange, 0b11100100),
            IoStatus::Ok);  // channel 0: 0..5 V, 1: 0..10 V, 2: +-5 V, 3: +-10 V
  EXPECT_EQ(simulation::outputVolts(image), (std::array<double, 4>{0, 0, -5, -10}));
}

TEST(Pci1720Model, UpdatesAtOnceUnlessSynchronous) {
  simulation::Pci1720Image image;
  simulation::Pci1720Model model(image);
  model.write8(pci1720::lowByte(2), 0x00);
  model.write8(pci1720::highByte(2), 0xF8);  // the upper four bits do not exist
  EXPECT_DOUBLE_EQ(simulation::outputVolts(image)[2], 2.5);
  model.write8(pci1720::kSynchronousMode, 1);
  model.write8(pci1720::highByte(2), 0x04);
  EXPECT_DOUBLE_EQ(simulation::outputVolts(image)[2], 2.5);
  model.write8(pci1720::kSynchronise, 0);
  EXPECT_DOUBLE_EQ(simulation::outputVolts(image)[2], 1.25);
}

TEST(Pci1720, NeverGivesANegativePulseWhenAColdCardIsInitialised) {
  HeapCards cards;
  ASSERT_TRUE(cards.bench.bus().selfTest().passed);
  ASSERT_FALSE(cards.bench.seenOutputs().empty());
  for (const auto& seen : cards.bench.seenOutputs()) {
    for (const double volts : seen) {
      EXPECT_GE(volts, 0.0);
      EXPECT_LE(volts, 2.5);
    }
  }
}

TEST(Pci1720, MovesAWarmCardStraightFromWhatItHeldToZero) {
  HeapCards cards;
  std::array<double, 4> held{};
  ASSERT_TRUE(cards.bench.bus().selfTest().passed);
  ASSERT_EQ(cards.bench.bus().writeVolts({-7, 7, -1, 1}, held), IoStatus::Ok);
  cards.bench.seenOutputs().clear();
  ASSERT_TRUE(cards.bench.bus().selfTest().passed);
  const std::array<double, 4> zero{0, 0, 0, 0};
  for (const auto& seen : cards.bench.seenOutputs())
    EXPECT_TRUE(seen == held || seen == zero);
}

TEST(PciAxisBus, DisablesTheDrivesBeforeItTouchesTheAnalogOutputs) {
  simulation::RobotImage image;
  simulation::Pci1720Model analog(image.analog);
  simulation::Pci1784Model counter(image.counter);
  image.counter.outputs.store(0x0F);  // left on by a process that died
  SpyRegisters analog_spy(analog);
  int accesses = 0;
  analog_spy.after_access = [&] {
    ++accesses;
    EXPECT_EQ(image.counter.outputs.load(), 0);
  };
  PciAxisBus bus(analog_spy, counter, {});
  ASSERT_TRUE(bus.selfTest().passed);
  EXPECT_GT(accesses, 0);
}

TEST(PciAxisBus, RefusesAnotherBoardIdAndSaysWhich) {
  simulation::RobotImage image;
  image.analog.board_id.store(3);
  simulation::Pci1720Model analog(image.analog);
  simulation::Pci1784Model counter(image.counter);
  PciAxisBus::Options options;
  options.analog_board_id = 5;
  PciAxisBus bus(analog, counter, options);
  const SelfTest result = bus.selfTest();
  EXPECT_FALSE(result.passed);
  EXPECT_NE(result.findings.back().find("board id 3 instead of 5"), std::string::npos) << result.findings.back();
}

TEST(PciAxisBus, NoticesAnotherCardInThePlaceOfTheTestedOne) {
  HeapCards cards;
  ASSERT_TRUE(cards.bench.bus().selfTest().passed);
  cards.image.analog.board_id.store(9);
  cards.image.counter.board_id.store(9);
  std::array<double, 4> written{};
  AxisFeedback feedback;
  EXPECT_EQ(cards.bench.bus().writeVolts({5, 5, 5, 5}, written), IoStatus::DeviceError);
  EXPECT_EQ(cards.bench.bus().read(feedback), IoStatus::DeviceError);
  EXPECT_EQ(cards.bench.terminalVolts(), (std::array<double, 4>{0, 0, 0, 0}));
}

/// A slot without a card: every read gives ones.
class EmptySlot : public RegisterAccess {
 public:
  IoStatus read8(std::uint32_t, std::uint8_t& value) noexcept override {
    value = 0xFF;
    return IoStatus::Ok;
  }
  IoStatus read32(std::uint32_t, std::uint32_t& value) noexcept override {
    value = 0xFFFFFFFFu;
    return IoStatus::Ok;
  }
  IoStatus write8(std::uint32_t, std::uint8_t) noexcept override { return IoStatus::Ok; }
  IoStatus write32(std::uint32_t, std::uint32_t) noexcept override { return IoStatus::Ok; }
};

TEST(PciAxisBus, FailsTheSelfTestWhenNobodyAnswers) {
  EmptySlot empty;
  HeapCards cards;
  simulation::Pci1784Model counter(cards.image.counter);
  EXPECT_FALSE(PciAxisBus(empty, empty, {}).selfTest().passed);
  EXPECT_FALSE(PciAxisBus(empty, counter, {}).selfTest().passed);
}

TEST(Pci1784Model, LatchesOnlyTheCountersWhoseBitIsWritten) {
  simulation::Pci1784Image image;
  simulation::Pci1784Model model(image);
  for (int channel = 0; channel < 4; ++channel)
    model.write32(pci1784::counter(channel), pci1784::kModeX4);
  model.write32(pci1784::kReset, 0x0F);
  simulation::publishCounts(image, {10, 20, 30, 40});
  model.write32(pci1784::kLatch, 0x05);
  const std::array<std::uint32_t, 4> expected{10, 0, 30, 0};
  for (int channel = 0; channel < 4; ++channel) {
    std::uint32_t value = 1;
    ASSERT_EQ(model.read32(pci1784::counter(channel), value), IoStatus::Ok);
    EXPECT_EQ(value, expected[static_cast<std::size_t>(channel)]);
  }
}

TEST(Pci1784Model, ResetsToTwoToThe31WithoutTheModeBitForZero) {
  simulation::Pci1784Image image;
  simulation::Pci1784Model model(image);
  simulation::publishCounts(image, {5, 5, 5, 5});
  model.write32(pci1784::counter(0), pci1784::kModeX4);
  model.write32(pci1784::counter(1), pci1784::kModeX4 & ~pci1784::kModeResetToZero);
  model.write32(pci1784::kReset, 0x0F);
  model.write32(pci1784::kLatch, 0x0F);
  std::uint32_t value = 1;
  ASSERT_EQ(model.read32(pci1784::counter(0), value), IoStatus::Ok);
  EXPECT_EQ(value, 0u);
  ASSERT_EQ(model.read32(pci1784::counter(1), value), IoStatus::Ok);
  EXPECT_EQ(value, 0x80000000u);
}

TEST(Pci1784, FailsTheSelfTestWhenACounterDoesNotReset) {
  simulation::RobotImage image;
  simulation::Pci1720Model analog(image.analog);
  simulation::Pci1784Model counter(image.counter);
  SpyRegisters racing(counter);
  racing.after_access = [&] {  // an encoder that runs by itself: noise, or a moving axis
    auto sums = simulation::publishedCounts(image.counter);
    sums[2] += 100;
    simulation::publishCounts(image.counter, sums);
  };
  const SelfTest result = PciAxisBus(analog, racing, {}).selfTest();
  EXPECT_FALSE(result.passed);
  EXPECT_NE(result.findings.back().find("counter 2"), std::string::npos) << result.findings.back();
}

TEST(CardModels, RefuseRegistersThatTheTablesDoNotHave) {
  simulation::RobotImage image;
  simulation::Pci1720Model analog(image.analog);
  simulation::Pci1784Model counter(image.counter);
  std::uint8_t byte = 0;
  std::uint32_t word = 0;
  EXPECT_EQ(analog.read8(0x0A, byte), IoStatus::OutOfRange);
  EXPECT_EQ(analog.write32(0x00, 0), IoStatus::OutOfRange);
  EXPECT_EQ(counter.read32(0x10, word), IoStatus::OutOfRange);
  EXPECT_EQ(counter.read32(0x02, word), IoStatus::OutOfRange);
  EXPECT_EQ(counter.write8(0x00, 0), IoStatus::OutOfRange);
}

TEST(CountDifference, IsHarmlessAcrossTheWrap) {
  EXPECT_EQ(countDifference(INT32_MIN, INT32_MAX), 1);
  EXPECT_EQ(countDifference(INT32_MAX, INT32_MIN), -1);
  EXPECT_EQ(countDifference(5, -7), 12);
}

}  // namespace
}  // namespace knee_robot::hardware
