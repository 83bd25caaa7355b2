// The component alone, cycle by cycle.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "some_model.h"
#include "src/control/hand_guide.h"
#include "test/allocation_guard.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::control {
namespace {

struct HandGuideFeed : rt::TaskContext {
  HandGuideFeed() : rt::TaskContext("HandGuideFeed") {}
  rt::OutputPort<SupervisorCommand> orders{*this, "orders", ""};
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", ""};
  rt::OutputPort<AxisCommand> command_2{*this, "command_2", ""};
  rt::InputPort<Guidance> guidance{*this, "guidance", ""};
};

class HandGuideAlone : public ::testing::Test {
 protected:
  void SetUp() override {
    rt::connect(feed.orders, guide.orders);
    rt::connect(feed.measurement, guide.measurement);
    rt::connect(feed.command_2, guide.command_2);
    rt::connect(guide.guidance, feed.guidance);
    const std::string model = ::testing::TempDir() + std::to_string(::getpid()) + "_guide_alone.yaml";
    dynamics::saveModel(fake::modelOf(robot), model);
    guide.model.set(model);
    ASSERT_TRUE(guide.configure()) << guide.refusal();
    std::remove(model.c_str());
    ASSERT_TRUE(guide.start());
    orders.level = DriveLevel::Released;
    orders.guiding = orders.drivers_active = orders.homed = true;
    measured.status = hardware::IoStatus::Ok;
  }
  void cycle(bool speaks) {
    now += 1'000'000;
    ++measured.sequence;
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      measured.position_m[i] = robot.actuators[i].home_length_m + 0.02 * std::sin(1e-9 * static_cast<double>(now));
    feed.measurement.write(measured);
    if (speaks) feed.orders.write(orders);
    rt::Cycle c;
    c.time = c.wake = now;
    c.period = 1'000'000;
    guide.update(c);
    feed.guidance.read(said);
  }

  const mechanism::Robot robot = mechanism::configuredRobot("A");
  HandGuide guide{"Guide", robot};
  HandGuideFeed feed;
  SupervisorCommand orders;
  AxesMeasurement measured;
  Guidance said;
  rt::Nanoseconds now = 0;
};

TEST_F(HandGuideAlone, AllocatesNothingAndLetsGoWhenTheSupervisorIsSilent) {
  allocations = 0;
  armed = true;
  for (int k = 0; k < 2000; ++k)
    cycle(true);
  armed = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(said.active) << static_cast<int>(said.stop);
  EXPECT_GT(guide.path().size(), 100u);
  for (int k = 0; k < 10; ++k)
    cycle(false);
  EXPECT_FALSE(said.active) << "the Drivers hold";
}

TEST_F(HandGuideAlone, GuidesAgainAfterAVelocityThatWasNoNumber) {
  for (int k = 0; k < 2000; ++k)
    cycle(true);
  ASSERT_TRUE(said.active);
  measured.velocity_m_per_s[1] = std::nan("");
  cycle(true);
  EXPECT_FALSE(said.active);
  EXPECT_EQ(said.stop, GuideStop::LostPose);
  measured.velocity_m_per_s[1] = 0.0;
  for (int k = 0; k < 2000; ++k)
    cycle(true);
  EXPECT_TRUE(said.active) << "a number again: " << static_cast<int>(said.stop);
}

TEST_F(HandGuideAlone, HandsNothingToTheDriversThatIsNoNumber) {
  for (const int weighed : {100, 2000}) {
    for (int k = 0; k < weighed; ++k)
      cycle(true);
    AxisCommand broken;
    broken.axis = 2;
    broken.force_N = std::nan("");
    feed.command_2.write(broken);
    bool stopped = false;
    for (int k = 0; k < 1000; ++k) {
      cycle(true);
      stopped = stopped || said.stop == GuideStop::LostPose || said.stop == GuideStop::UnknownLoad;
      for (const double force : said.force_N)
        ASSERT_TRUE(std::isfinite(force)) << "cycle " << k << " after " << weighed;
    }
    EXPECT_TRUE(stopped);
    feed.command_2.write(AxisCommand{});
    for (int k = 0; k < 2000; ++k)
      cycle(true);
    EXPECT_TRUE(said.active) << "a number again: " << static_cast<int>(said.stop);
  }
}

}  // namespace
}  // namespace knee_robot::control
