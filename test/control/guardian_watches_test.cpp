// By what the guardian tells a brake that slips.
#include <fstream>
#include <sstream>

#include "guarded_robot.h"

namespace knee_robot::control {
namespace {

using namespace guarded;

TEST(TheGuardian, WatchesForTheSlipOfTheDeployment) {
  std::ifstream in(holding::file("config/deployment/simulation.yaml"));
  std::stringstream text;
  text << in.rdbuf();
  std::string content = text.str();
  const std::string plain = "{name: AxesOutput, type: AxesOutput, activity: servo}";
  ASSERT_NE(content.find(plain), std::string::npos);
  content.replace(content.find(plain), plain.size(),
                  "{name: AxesOutput, type: AxesOutput, activity: servo, properties: {slip_m: 0.002}}");
  const std::string path = ::testing::TempDir() + "slip_" + std::to_string(::getpid()) + ".yaml";
  std::ofstream(path) << content;
  for (const bool wide : {false, true}) {
    Guarded robot(true, wide ? path : "");
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      const double count_m = robot.robot.actuators[i].metresPerCount();
      EXPECT_NEAR(robot.link.slip_counts[i].load() * count_m, wide ? 0.002 : 0.0005, 1.1 * count_m);
      EXPECT_NEAR(robot.link.counts_per_mm[i].load() * count_m, 0.001, 1e-12);
    }
  }
  std::remove(path.c_str());
}

/// Noise that comes when the controller is about to die.
TEST(TheGuardian, TakesNoNoiseOfAnEncoderForABrakeThatSlips) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    Guarded robot(true);
    robot.image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Noise));
    robot.image.faults.encoder_size_m[axis].store(0.001);
    const AfterDeath after = robot.dies();
    EXPECT_EQ(after.slipped, 0) << axis + 1;
    EXPECT_LT(after.on_s, 0.45) << "once 2 s";
    EXPECT_LT(after.drop_m, 0.001);
  }
}

TEST(TheGuardian, FindsBrakesThatSlipBehindANoisyEncoder) {
  for (const std::uint8_t late : {1, 8, 15}) {
    Guarded robot(true);
    robot.image.faults.hold_late.store(late);
    robot.image.faults.encoder[late == 8 ? 3 : 0].store(static_cast<std::uint8_t>(simulation::EncoderFault::Noise));
    robot.image.faults.encoder_size_m[late == 8 ? 3 : 0].store(0.001);
    const AfterDeath after = robot.dies();
    EXPECT_NE(after.slipped, 0) << int{late};
    EXPECT_LT(after.drop_m, 0.015) << int{late};
    EXPECT_LT(after.on_s, 1.3) << int{late};
  }
}

}  // namespace
}  // namespace knee_robot::control
