// A controller that is started anew does not believe in cold motors.
#include "src/control/heat_memory.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST_F(HeatFile, IsLessByTheCoolingSince) {
  const std::string kept = file("heat: [0.8, 0.4, 0, 3]\ntime_s: 1000\n");
  const AxisValues heat = rememberedHeat(kept, 1020.0, 20.0);
  EXPECT_NEAR(heat[0], 0.8 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(heat[1], 0.4 * std::exp(-1.0), 1e-12);
  EXPECT_EQ(heat[2], 0.0);
  EXPECT_EQ(heat[3], 1.0) << "never above: a fault at once would say nothing of now";
  EXPECT_EQ(rememberedHeat(kept, 10.0, 20.0)[0], 0.8) << "a clock that was set back cools nothing";
}

TEST_F(HeatFile, IsColdWhereThereIsNoneAndHotWhereItCannotBeUnderstood) {
  std::string error;
  EXPECT_EQ(rememberedHeat(path(), 10.0, 20.0, &error), AxisValues{});
  EXPECT_EQ(rememberedHeat("", 10.0, 20.0, &error), AxisValues{});
  EXPECT_EQ(error, "");
  for (const char* bad : {"", "heat: [1, 2]\ntime_s: 3\n", "heat: [0, 0, 0, nan]\ntime_s: 3\n", "\xff\xfe{{{",
                          "heat: [0, 0, 0, -1]\ntime_s: 3\n", "heat: [0, 0, 0, 0]\n"}) {
    error.clear();
    const AxisValues heat = rememberedHeat(file(bad), 10.0, 20.0, &error);
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
