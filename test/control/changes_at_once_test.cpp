// Two who change the controller at the same time: what each of them may alone, both together may not.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "holding_robot.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using holding::file;

const char* const kPatient = R"(patient: "17"
pose: {X_m: [-0.1, 0.1], Z_m: [0.58, 0.68], theta_deg: [-10, 10], psi_deg: [-10, 10]}
)";

/// A controller of robot A that runs, drives off.
struct Controller {
  explicit Controller(const std::string& deployment = file("config/deployment/simulation.yaml"), double delay_s = 0.0)
      : robot(mechanism::loadRobot(file("config/robots/A.yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot),
              simulation::loadSimulationParameters(file("config/simulation/A.yaml")), image),
        bus(simulation::openImageCards(image)) {
    dynamics::saveModel(delay_s > 0.0 ? fake::tracedModelOf(robot, {fake::delayOf(2, delay_s)}) : fake::modelOf(robot),
                        folder + "/model.yaml");
    writeFileAtomically(folder + "/p17.yaml", kPatient);
    ControlSystem::Options options;
    options.execution = rt::Execution::Stepped;
    options.empty = true;
    options.model = folder + "/model.yaml";
    system = std::make_unique<ControlSystem>(robot, loadHardwareFile(file("config/hardware/simulated.yaml")),
                                             deployment, *bus, options);
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time))
        plant.step(0.001);
    });
    EXPECT_TRUE(system->start().ok);
    system->run(0.1);
  }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  const TemporaryFolder folder;
  std::unique_ptr<hardware::AxisBus> bus;
  std::unique_ptr<ControlSystem> system;
};

/// `other` again and again while `one` is done `times` times.
template <typename One, typename Other>
void meanwhile(int times, One&& one, Other&& other) {
  std::atomic<bool> ended{false};
  std::thread thread([&] {
    while (!ended.load())
      other();
  });
  for (int i = 0; i < times; ++i)
    one();
  ended = true;
  thread.join();
}

std::string passiveDeployment(const std::string& folder) {
  std::string text = readFile(file("config/deployment/simulation.yaml"));
  const std::string line = "type: ModelFeedforward, activity: servo";
  text.insert(text.find(line) + line.size(), ", properties: {law: passivity_based}");
  const std::string path = folder + "/changes_at_once.yaml";
  writeFileAtomically(path, text);
  return path;
}

TEST(ChangesAtOnce, OfTwoGainsLeaveALawThatIsPassive) {
  const std::string deployment = passiveDeployment(::testing::TempDir());
  Controller controller(deployment);
  ControlSystem& system = *controller.system;
  const auto set = [&](const char* gain, const char* value) { return system.setProperty("Driver2", gain, value).ok; };
  const auto* driver = system.deployment().component("Driver2");
  const rt::PropertyBase* const proportional = driver->property("proportional_N_per_m");
  int changed = 0, both = 0;
  meanwhile(
      50000,
      [&] {
        if (!set("integral_N_per_m_s", "500000")) return;
        ++changed;
        both += std::stod(proportional->valueText()) < 55000.0 ? 1 : 0;
        set("integral_N_per_m_s", "300000");
      },
      [&] {
        set("proportional_N_per_m", "50000");
        set("proportional_N_per_m", "60000");
      });
  std::remove(deployment.c_str());
  EXPECT_GT(changed, 0);
  EXPECT_EQ(both, 0) << "of " << changed << ": each was judged with the other's gain as it had been";
}

TEST(ChangesAtOnce, OfAGainLeaveAPatientWithTheGainsThatWereJudged) {
  Controller controller;
  ControlSystem& system = *controller.system;
  const rt::PropertyBase* const gain = system.deployment().component("Driver4")->property("proportional_N_per_m");
  int loaded = 0, tried_out = 0;
  meanwhile(
      2000,
      [&] {
        if (!system.loadPatient(controller.folder + "/p17.yaml").ok) return;
        ++loaded;
        tried_out += std::stod(gain->valueText()) < 40000.0 ? 1 : 0;
        while (!system.declareEmpty().ok)
          std::this_thread::yield();
      },
      [&] {
        for (const char* value : {"8", "60000"}) {
          system.setProperty("Driver4", "proportional_N_per_m", value);
          std::this_thread::sleep_for(std::chrono::microseconds(20));
        }
      });
  EXPECT_GT(loaded, 0);
  EXPECT_EQ(tried_out, 0) << "of " << loaded << " loadings";
}

TEST(ChangesAtRunTime, AreJudgedByTheTracedDelayOfTheAxis) {
  Controller controller(file("config/deployment/simulation.yaml"), 0.006);
  ControlSystem& system = *controller.system;
  const Answer stiff = system.setProperty("Driver2", "proportional_N_per_m", "400000");
  EXPECT_FALSE(stiff.ok);
  EXPECT_NE(stiff.sentence.find("axis 2 acts 6 ms late"), std::string::npos) << stiff.sentence;
  EXPECT_TRUE(system.setProperty("Driver3", "proportional_N_per_m", "400000").ok) << "no delay was traced there";
  EXPECT_TRUE(system.setProperty("Driver2", "proportional_N_per_m", "35000").ok);
}

}  // namespace
}  // namespace knee_robot::control
