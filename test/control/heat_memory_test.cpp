// A controller that is started anew does not believe in cold motors.
#include "src/control/heat_memory.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "system_rig.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

class HeatFile : public ::testing::Test {
 protected:
  std::string path() const { return folder_ + "/deep/heat.yaml"; }
  std::string file(const std::string& content) const {
    writeFileAtomically(folder_ + "/heat.yaml", content);
    return folder_ + "/heat.yaml";
  }

  const TemporaryFolder folder_;
};

constexpr double kHour = 3600.0;

/// A moment of boot `boot`, so many seconds after it began.
Moment moment(const std::string& boot, double since_boot_s, double wall_s, bool synchronized = false) {
  return {wall_s, since_boot_s, boot, synchronized};
}

TEST_F(HeatFile, IsLessByTheCoolingSince) {
  const std::string kept = file("heat: [0.8, 0.4, 0, 3]\ntime_s: 1000\nboot: a\nsince_boot_s: 500\n");
  const AxisValues heat = rememberedHeat(kept, moment("a", 520.0, 1020.0), 20.0);
  EXPECT_NEAR(heat[0], 0.8 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(heat[1], 0.4 * std::exp(-1.0), 1e-12);
  EXPECT_EQ(heat[2], 0.0);
  EXPECT_EQ(heat[3], 1.0) << "never above: a fault at once would say nothing of now";
}

TEST_F(HeatFile, CoolsByWhatWentByHoweverTheWallClockWasSetMeanwhile) {
  const std::string kept = file("heat: [0.95, 0, 0, 0]\ntime_s: 1e9\nboot: a\nsince_boot_s: 500\n");
  for (const double wall_s : {1e9 + 2.0, 1e9 + 2.0 * kHour, 1e9 - 2.0 * kHour})
    EXPECT_NEAR(rememberedHeat(kept, moment("a", 502.0, wall_s, true), 1100.0)[0], 0.95, 2e-3) << wall_s;
}

TEST(LeastSecondsBetween, IsTheUptimeAfterAnotherBootAndMoreOnlyByClocksThatATimeServerKept) {
  const Moment evening = moment("a", 9000.0, 1e9), kept_evening = moment("a", 9000.0, 1e9, true);
  const double morning = 1e9 + 12.0 * kHour;
  EXPECT_EQ(leastSecondsBetween(evening, moment("b", 60.0, morning)), 60.0);
  EXPECT_EQ(leastSecondsBetween(evening, moment("b", 60.0, morning, true)), 60.0);
  EXPECT_EQ(leastSecondsBetween(kept_evening, moment("b", 60.0, morning)), 60.0);
  EXPECT_EQ(leastSecondsBetween(kept_evening, moment("b", 60.0, morning, true)), 12.0 * kHour);
  EXPECT_EQ(leastSecondsBetween(kept_evening, moment("b", 60.0, 1e9 - kHour, true)), 60.0) << "so much is sure";
}

TEST(LeastSecondsBetween, IsTheWallClocksUpToTheUptimeWhereABootIsNotKnown) {
  const Moment of_old = moment("", 0.0, 1000.0);
  EXPECT_EQ(leastSecondsBetween(of_old, moment("b", 900.0, 1020.0)), 20.0) << "perhaps in this very boot";
  EXPECT_EQ(leastSecondsBetween(of_old, moment("b", 900.0, 1000.0 + 2.0 * kHour, true)), 900.0);
  EXPECT_EQ(leastSecondsBetween(of_old, moment("b", 900.0, 10.0)), 0.0) << "a clock that was set back cools nothing";
  EXPECT_EQ(leastSecondsBetween(moment("a", 800.0, 1000.0), moment("", 900.0, 1020.0)), 20.0);
}

TEST_F(HeatFile, OfAnEarlierReleaseIsRead) {
  std::string error;
  const std::string kept = file("heat: [0.8, 0.4, 0, 0]\ntime_s: 1000\n");
  EXPECT_NEAR(rememberedHeat(kept, moment("b", 900.0, 1020.0), 20.0, &error)[0], 0.8 * std::exp(-1.0), 1e-12);
  EXPECT_EQ(error, "");
}

TEST_F(HeatFile, IsHotWhereTheClockWasSetAheadBetweenTwoStarts) {
  {
    fake::Rig rig(fake::hardware(), "", path());
    rig.hold();
    rig.system.run(20.0);
  }
  const Moment now = momentNow();
  ASSERT_FALSE(now.boot.empty());
  const AxisValues at_once = rememberedHeat(path(), now, 1100.0);
  Moment ahead = now;
  ahead.wall_s += 2.0 * kHour;
  EXPECT_GT(at_once[0], 1e-4);
  EXPECT_EQ(rememberedHeat(path(), ahead, 1100.0), at_once);
}

TEST_F(HeatFile, IsColdWhereThereIsNoneAndHotWhereItCannotBeUnderstood) {
  std::string error;
  EXPECT_EQ(rememberedHeat(path(), moment("a", 10.0, 10.0), 20.0, &error), AxisValues{});
  EXPECT_EQ(rememberedHeat("", moment("a", 10.0, 10.0), 20.0, &error), AxisValues{});
  EXPECT_EQ(error, "");
  for (const char* bad :
       {"", "heat: [1, 2]\ntime_s: 3\n", "heat: [0, 0, 0, nan]\ntime_s: 3\n", "\xff\xfe{{{",
        "heat: [0, 0, 0, -1]\ntime_s: 3\n", "heat: [0, 0, 0, 0]\n", "heat: [0, 0, 0, 0]\ntime_s: 3\nboot: a\n"}) {
    error.clear();
    const AxisValues heat = rememberedHeat(file(bad), moment("a", 10.0, 10.0), 20.0, &error);
    EXPECT_EQ(heat, (AxisValues{1.0, 1.0, 1.0, 1.0})) << bad;
    EXPECT_NE(error.find("heat.yaml"), std::string::npos) << error;
  }
}

TEST_F(HeatFile, OutlivesTheController) {
  std::array<double, hardware::kAxes> before{};
  {
    fake::Rig rig(fake::hardware(), "", path());
    rig.hold();
    rig.system.run(20.0);
    before = rig.system.status().thermal;
  }
  ASSERT_GT(before[0], 1e-4) << "the axes carry nothing";
  fake::Rig again(fake::hardware(), "", path());
  ASSERT_TRUE(again.system.start().ok);
  again.system.run(0.1);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    EXPECT_NEAR(again.system.status().thermal[i], before[i], 0.1 * before[i]) << i;  // a real second or two of cooling
}

TEST_F(HeatFile, IsKeptWhereADiskHasNoRoomForANewFile) {
  const std::string long_name = folder_ + "/" + std::string(250, 'h');  // a file beside it would have too long a name
  const int made = ::open(long_name.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  const std::string cold = "heat: [0, 0, 0, 0]\ntime_s: 3\n" + std::string(300, '\n');
  ASSERT_EQ(::write(made, cold.data(), cold.size()), static_cast<ssize_t>(cold.size()));
  ::close(made);
  ASSERT_THROW(writeFileAtomically(long_name, cold), InputError);
  {
    fake::Rig rig(fake::hardware(), "", long_name);
    rig.hold();
    rig.system.run(20.0);
  }
  std::string error;
  EXPECT_GT(rememberedHeat(long_name, momentNow(), 1100.0, &error)[0], 1e-4);
  EXPECT_EQ(error, "");
}

TEST_F(HeatFile, ThatCannotBeReadIsNamedAtTheStart) {
  fake::Rig rig(fake::hardware(), "", file("nonsense"));
  const Answer answer = rig.system.start();
  EXPECT_TRUE(answer.ok);
  EXPECT_NE(answer.sentence.find("count as hot"), std::string::npos) << answer.sentence;
  rig.system.run(0.1);
  EXPECT_GT(rig.system.status().thermal[0], 0.99);
}

}  // namespace
}  // namespace knee_robot::control
