#include "knee_robot/simulation/shared_image.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "test/hardware/card_bench.h"
#include "test/refusal.h"

namespace knee_robot::simulation {
namespace {

TEST(SharedImage, IsSeenByBothSidesAndGoneAfterItsCreator) {
  const std::string name = hardware::uniqueShmName("both");
  {
    SharedImage plant = SharedImage::create(name);
    SharedImage controller = SharedImage::attach(name);
    plant.image().plant_heartbeat.store(41);
    EXPECT_EQ(controller.image().plant_heartbeat.load(), 41u);
    EXPECT_EQ(controller.image().plant_pid.load(), ::getpid());
  }
  EXPECT_NE(refusalOf([&] { SharedImage::attach(name); }).find("no simulated robot"), std::string::npos);
}

TEST(SharedImage, OfAnotherUserIsRefusedWithWhatToDo) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  const std::string name = hardware::uniqueShmName("root");
  const SharedImage of_root = SharedImage::create(name);
  ASSERT_EQ(::seteuid(65534), 0);
  const std::string created = refusalOf([&] { SharedImage::create(name); });
  const std::string attached = refusalOf([&] { SharedImage::attach(name); });
  ASSERT_EQ(::seteuid(0), 0);
  EXPECT_NE(created.find("belongs to another user"), std::string::npos) << created;
  EXPECT_NE(attached.find("belongs to another user"), std::string::npos) << attached;
}

TEST(SharedImage, SurvivesAControllerThatIsKilledWithItsOutputsHeld) {
  SharedImage plant = SharedImage::create(hardware::uniqueShmName("kill"));
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t controller = ::fork();
  ASSERT_GE(controller, 0);
  if (controller == 0) {
    const auto bus = openSimulatedCards(plant.name());
    std::array<double, hardware::kAxes> written{};
    const bool good = bus->selfTest().passed &&
                      bus->writeVolts({1.25, -2.5, 5.0, 0.0}, written) == hardware::IoStatus::Ok &&
                      bus->writeOutputs(0x03) == hardware::IoStatus::Ok;
    const char answer = good ? 'y' : 'n';
    if (::write(ready[1], &answer, 1) != 1) ::_exit(1);
    for (;;)
      ::pause();
  }
  char answer = 0;
  ASSERT_EQ(::read(ready[0], &answer, 1), 1);
  EXPECT_EQ(answer, 'y');
  ::kill(controller, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(controller, &status, 0), controller);
  EXPECT_TRUE(WIFSIGNALED(status));
  ::close(ready[0]);
  ::close(ready[1]);
  EXPECT_EQ(outputVolts(plant.image().analog), (std::array<double, 4>{1.25, -2.5, 5.0, 0.0}));
  EXPECT_EQ(plant.image().counter.outputs.load(), 0x03);
  const auto successor =
      openSimulatedCards(plant.name());  // a controller that comes back finds the cards and silences them
  ASSERT_TRUE(successor->selfTest().passed);
  EXPECT_EQ(outputVolts(plant.image().analog), (std::array<double, 4>{0, 0, 0, 0}));
}

TEST(SharedImage, RefusesASecondPlantUnderTheSameName) {
  const SharedImage plant = SharedImage::create(hardware::uniqueShmName("second"));
  const std::string message = refusalOf([&] { SharedImage::create(plant.name()); });
  EXPECT_NE(message.find("already simulates"), std::string::npos) << message;
  EXPECT_NE(message.find(std::to_string(::getpid())), std::string::npos) << message;
}

TEST(SharedImage, ReplacesWhatADeadPlantLeft) {
  const std::string name = hardware::uniqueShmName("dead");
  const pid_t dead = ::fork();
  ASSERT_GE(dead, 0);
  if (dead == 0) {
    SharedImage plant = SharedImage::create(name);
    plant.image().plant_heartbeat.store(7);
    ::_exit(0);  // without unlinking, as after SIGKILL
  }
  ASSERT_EQ(::waitpid(dead, nullptr, 0), dead);
  SharedImage plant = SharedImage::create(name);
  EXPECT_EQ(plant.image().plant_heartbeat.load(), 0u);
}

TEST(SharedImage, RefusesForeignMemoryAndMalformedNames) {
  const std::string name = hardware::uniqueShmName("foreign");
  const int descriptor = ::shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
  ASSERT_GE(descriptor, 0);
  EXPECT_NE(refusalOf([&] { SharedImage::attach(name); }).find("just starting"), std::string::npos);
  ASSERT_EQ(::ftruncate(descriptor, 100), 0);
  EXPECT_NE(refusalOf([&] { SharedImage::attach(name); }).find("holds 100 bytes"), std::string::npos);
  ASSERT_EQ(::ftruncate(descriptor, sizeof(RobotImage)), 0);
  EXPECT_NE(refusalOf([&] { SharedImage::attach(name); }).find("just starting"), std::string::npos);
  ::close(descriptor);
  ::shm_unlink(name.c_str());
  for (const char* bad : {"", "/", "knee", "/a/b"}) {
    EXPECT_NE(refusalOf([&] { SharedImage::create(bad); }).find("must be a slash"), std::string::npos) << bad;
  }
}

TEST(SharedImage, RefusesAnotherVersion) {
  SharedImage plant = SharedImage::create(hardware::uniqueShmName("version"));
  plant.image().version = RobotImage::kVersion + 1;
  EXPECT_NE(refusalOf([&] { SharedImage::attach(plant.name()); }).find("build both"), std::string::npos);
}

}  // namespace
}  // namespace knee_robot::simulation
