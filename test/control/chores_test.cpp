// What is written down beside the real-time threads.
#include "src/control/chores.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace knee_robot::control {
namespace {

TEST(Chores, GoOnWhereOneOfThemFails) {
  std::atomic<int> done{0};
  {
    const Chores chores(true, {[] { throw std::runtime_error("the disk"); }, [&] { ++done; }}, 0.01);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (done < 3 && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_GE(done, 3);
}

TEST(Chores, AreDoneByNobodyInAControllerThatIsStepped) {
  int done = 0;
  {
    const Chores chores(false, {[&] { ++done; }}, 0.001);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(done, 0);
}

}  // namespace
}  // namespace knee_robot::control
