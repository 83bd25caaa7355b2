// What a periodic thread calls must not allocate: every operator new of this program is counted.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <new>

#include "knee_robot/hardware/open_bus.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "test/simulation/plant_bench.h"

namespace {
long allocations = 0;

void* allocate(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace knee_robot {
namespace {

TEST(RealTimePath, OfBusAndPlantAllocatesNothing) {
  const Robot robot = configuredRobot("A");
  const auto parameters = loadSimulationParameters(std::string(KNEE_SOURCE_DIR) + "/config/simulation/A.yaml");
  hardware::RobotImage image;
  RobotSimulation simulation(robot, loadRobotInertia(robot), parameters, image);
  const auto bus = hardware::openImageCards(image);
  ASSERT_TRUE(bus->selfTest().passed);
  const long before = allocations;
  ASSERT_GT(before, 0);  // the counter counts
  hardware::AxisFeedback feedback;
  std::array<double, 4> written{};
  bool good = bus->writeOutputs(3) == hardware::IoStatus::Ok;
  for (int i = 0; i < 300; ++i) {  // falls, is pushed about, rests on its stops
    good = good && bus->read(feedback) == hardware::IoStatus::Ok;
    good =
        good && bus->writeVolts({std::sin(0.05 * i), 1.0, std::cos(0.03 * i), 2.0}, written) == hardware::IoStatus::Ok;
    good = good && simulation.step(1e-3);
  }
  good = good && bus->writeVolts({NAN, 0, 0, 0}, written) == hardware::IoStatus::NotFinite;
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace knee_robot
