// The plant and the controller use the counter card's image at the same time, without a lock.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "knee_robot/simulation/simulated_cards.h"

namespace knee_robot::hardware {
namespace {

TEST(CounterImage, GivesTheFourCountsOfOneInstantWhileThePlantPublishes) {
  simulation::RobotImage image;
  const auto bus = simulation::openImageCards(image);
  ASSERT_TRUE(bus->selfTest().passed);
  std::atomic<bool> stop{false};
  std::thread plant([&] {
    for (std::uint32_t sum = 1; !stop.load(); ++sum) {
      simulation::publishCounts(image.counter, {sum, sum, sum, sum});
      std::this_thread::yield();
    }
  });
  int torn = 0;
  std::int32_t last = 0;
  int changes = 0;
  for (int i = 0; i < 200000 || changes < 100; ++i) {  // until both have really run side by side
    AxisFeedback feedback;
    if (bus->read(feedback) != IoStatus::Ok) ++torn;
    for (const std::int32_t count : feedback.counts)
      torn += count != feedback.counts[0];
    if (feedback.counts[0] < last) ++torn;  // time runs one way
    changes += feedback.counts[0] != last;
    last = feedback.counts[0];
  }
  stop.store(true);
  plant.join();
  EXPECT_EQ(torn, 0);
}

}  // namespace
}  // namespace knee_robot::hardware
