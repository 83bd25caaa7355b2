#include "src/control/reference_store.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace knee_robot::control {
namespace {

ReferencePath filled(std::size_t count, double value) {
  return ReferencePath::of(std::vector<AxisValues>(count, AxisValues{value, value, value, value}));
}

TEST(ReferencePath, IsLinearBetweenPointsAndHeldBeyondItsEnds) {
  const ReferencePath path = ReferencePath::of({{0.6, 0, 0, 0}, {0.601, 0, 0, 0}, {0.604, 0, 0, 0}});
  EXPECT_DOUBLE_EQ(path.duration(), 0.02);
  EXPECT_NEAR(path.positionAt(0.005)[0], 0.6005, 1e-12);
  EXPECT_NEAR(path.positionAt(0.015)[0], 0.6025, 1e-12);
  EXPECT_DOUBLE_EQ(path.positionAt(-1.0)[0], 0.6);
  EXPECT_DOUBLE_EQ(path.positionAt(7.0)[0], 0.604);
  EXPECT_NEAR(path.velocityAt(0.01)[0], 0.2, 1e-12);
  EXPECT_DOUBLE_EQ(path.velocityAt(0.0)[0], 0.0);
  EXPECT_DOUBLE_EQ(path.velocityAt(0.02)[0], 0.0);
  EXPECT_NEAR(path.fastest[0], 0.3, 1e-12);
  EXPECT_DOUBLE_EQ(ReferencePath::of({{0.6, 0, 0, 0}}).positionAt(1.0)[0], 0.6);
}

TEST(ReferenceStore, HandsOverTheNewestOffer) {
  ReferenceStore store;
  EXPECT_EQ(store.adopt(), nullptr);
  store.offer(filled(2, 1.0));
  store.offer(filled(3, 2.0));
  const ReferencePath* path = store.adopt();
  ASSERT_NE(path, nullptr);
  EXPECT_EQ(path->points.size(), 3u);
  EXPECT_EQ(store.adopt(), path) << "nothing new";
}

TEST(ReferenceStore, LeavesThePathThatIsPlayedAlone) {
  ReferenceStore store;
  store.offer(filled(2, 1.0));
  const ReferencePath* playing = store.adopt();
  store.offer(filled(9, 2.0));
  store.offer(filled(9, 3.0));
  EXPECT_EQ(playing->points.size(), 2u);
  EXPECT_EQ(playing->points[1][3], 1.0);
  EXPECT_EQ(store.adopt()->points[0][0], 3.0);
}

TEST(ReferenceStore, NeverShowsAHalfFilledPathBetweenTwoThreads) {
  ReferenceStore store;
  std::atomic<bool> done{false};
  std::thread offering([&] {
    for (int i = 1; i <= 5000; ++i)
      store.offer(filled(static_cast<std::size_t>(1 + i % 7), i));
    done = true;
  });
  double last = 0.0;
  while (!done.load()) {
    const ReferencePath* path = store.adopt();
    if (path == nullptr) continue;
    const double value = path->points.front()[0];
    EXPECT_EQ(path->points.size(), static_cast<std::size_t>(1 + static_cast<int>(value) % 7));
    for (const AxisValues& point : path->points)
      EXPECT_EQ(point[3], value);
    EXPECT_GE(value, last);
    last = value;
  }
  offering.join();
  EXPECT_EQ(store.adopt()->points.front()[0], 5000.0);
}

}  // namespace
}  // namespace knee_robot::control
