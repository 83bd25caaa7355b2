// The whole controller on the simulated robot A, stepped. At rest nobody is shaken while nothing happens, and a push finds a dead encoder.
// With a model it says who pushes, what is carried, whose friction has changed, and whether the model still holds.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <set>

#include "knee_robot/control/control_system.h"
#include "knee_robot/control/disturbance_sentences.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "some_model.h"

namespace knee_robot::control {
namespace {

std::string file(const std::string& name) {
  return std::string(KNEE_SOURCE_DIR) + "/" + name;
}

struct Truth {
  bool model = false;  // the controller has one of 150 N s/m, 15 N (leg 4: 60 N)
  double payload_kg = 0.0;
  double friction_3 = 1.0;   // times what the model knows
  double coulomb_4_N = 0.0;  // instead of the simulation file's
};

simulation::SimulationParameters parameters(const Truth& truth) {
  simulation::SimulationParameters all = simulation::loadSimulationParameters(file("config/simulation/A.yaml"));
  if (truth.payload_kg > 0.0) all.payload = simulation::Payload{truth.payload_kg, {0.0, 0.0, 0.05}, 0.1};
  for (auto& axis : all.axes)
    axis.viscous_N_s_per_m = 150.0;
  all.axes[2].viscous_N_s_per_m *= truth.friction_3;
  all.axes[2].coulomb_N *= truth.friction_3;
  if (truth.coulomb_4_N > 0.0) all.axes[3].coulomb_N = truth.coulomb_4_N;
  return all;
}

struct HoldingRobot {
  explicit HoldingRobot(const Truth& truth = {})
      : robot(mechanism::loadRobot(file("config/robots/A.yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot), parameters(truth), image),
        bus(simulation::openImageCards(image)) {
    ControlSystem::Options options;
    options.empty = true;
    options.execution = rt::Execution::Stepped;
    const std::string path = ::testing::TempDir() + "disturbance_" + std::to_string(::getpid()) + ".yaml";
    if (truth.model) {
      dynamics::Model model = fake::modelOf(robot, 150.0, 15.0, 60.0);
      for (std::size_t i = 0; i < 4; ++i)
        model.parameters[dynamics::extended::kRotor + i].value = 5.6;
      dynamics::saveModel(model, path);
      options.model = path;
    }
    system = std::make_unique<ControlSystem>(robot, loadHardwareFile(file("config/hardware/simulated.yaml")),
                                             file("config/deployment/simulation.yaml"), *bus, options);
    std::remove(path.c_str());
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time))
        plant.step(0.001);
      lowest = std::min(lowest, plant.state().pose[1]);
    });
    EXPECT_TRUE(system->start().ok);
    EXPECT_TRUE(system->enable().ok);
    system->run(3.0);  // every encoder has been asked once
  }
  void freeze(std::size_t axis) {
    image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
  }
  /// Up and down by 60 mm, four times, in 8 s each.
  void play(int points = 800) {
    trajectory::Reference reference;
    reference.name = "up_and_down";
    const mechanism::Pose home = plant.state().pose;
    reference.points.resize(4 * points + 1, 4);
    for (int k = 0; k <= 4 * points; ++k) {
      mechanism::Pose pose = home;
      pose[1] += 0.03 * (1.0 - std::cos(2.0 * M_PI * k / points));
      reference.points.row(k) = mechanism::legLengths(*robot.mechanism, pose).transpose();
    }
    // The first point is where the Drivers hold, not where the axes stick.
    reference.points.row(0) = reference.points.row(4 * points);
    ASSERT_TRUE(system->loadReference(reference).ok);
    ASSERT_TRUE(system->play().ok);
  }
  /// Everything that was said within `seconds`, each sentence without its numbers once.
  std::set<std::string> said(double seconds) {
    std::set<std::string> all;
    for (int k = 0; k < static_cast<int>(1000 * seconds); ++k) {
      system->step();
      const std::optional<Disturbance> now = system->disturbance();
      if (!now) continue;
      for (const Notice& notice : noticesOf(*now)) {
        last = notice.sentence;
        all.insert(notice.sentence.substr(0, notice.sentence.find(" about ")));
      }
    }
    return all;
  }
  void push(double newton) { image.surroundings.pose_force[1].store(-newton); }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  std::unique_ptr<hardware::AxisBus> bus;
  std::unique_ptr<ControlSystem> system;
  double lowest = 10.0;
  std::string last;
};

TEST(Disturbance, NobodyIsShakenWhileNothingHappens) {
  HoldingRobot robot;
  const mechanism::Pose before = robot.plant.state().pose;
  double farthest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    robot.system->step();
    farthest = std::max(farthest, (robot.plant.state().pose - before).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(farthest, 2e-5) << "m, rad; in 20 s";
  EXPECT_EQ(robot.system->state(), MachineState::Holding);
}

TEST(Disturbance, APushOf150NewtonFindsAnyFrozenEncoderBeforeThePlatformHasSunkBy5Millimetres) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    for (const double later_s : {0.0, 1.0}) {
      HoldingRobot robot;
      const double height = robot.plant.state().pose[1];
      robot.freeze(axis);
      robot.system->run(later_s);
      robot.push(150.0);
      robot.system->waitFor(MachineState::Faulted, 3.0);
      const ControlStatus status = robot.system->status();
      EXPECT_EQ(status.fault, Fault::EncoderFrozen) << "axis " << axis + 1 << ": " << status.fault_name;
      EXPECT_EQ(status.fault_axis, static_cast<int>(axis) + 1);
      EXPECT_LT(height - robot.lowest, 0.005) << "axis " << axis + 1 << ", push " << later_s << " s later";
    }
  }
}

TEST(Disturbance, AHealthyRobotHoldsAgainstTheSamePush) {
  HoldingRobot robot;
  const double height = robot.plant.state().pose[1];
  for (int k = 0; k < 5; ++k) {
    robot.push(150.0);
    robot.system->run(1.0);
    robot.push(0.0);
    robot.system->run(1.0);
  }
  EXPECT_EQ(robot.system->state(), MachineState::Holding) << robot.system->status().fault_sentence;
  EXPECT_LT(height - robot.lowest, 0.003);
}

const Truth kAsModelled{true, 0.0, 1.0};

/// Test pulses would spoil the recording of an empty robot: it is not asked before it would otherwise be called dead.
class Recorded : public ::testing::Test {
 protected:
  explicit Recorded() : path(::testing::TempDir() + "recorded_" + std::to_string(::getpid()) + ".csv") {}
  ~Recorded() override { std::remove(path.c_str()); }
  const std::string path;
};

TEST_F(Recorded, AnAxisWithHalfAsMuchFrictionAgainIsNotTakenForADeadEncoderWhereItTurns) {
  Truth truth;
  truth.coulomb_4_N = 100.0;
  HoldingRobot robot(truth);
  ASSERT_TRUE(robot.system->startRecording(path).ok);
  robot.play(300);
  robot.system->run(13.0);
  EXPECT_EQ(robot.system->state(), MachineState::Holding) << robot.system->status().fault_name;
}

TEST_F(Recorded, AnEncoderThatDiesInMotionIsStillFound) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    HoldingRobot robot;
    const double height = robot.plant.state().pose[1];
    ASSERT_TRUE(robot.system->startRecording(path).ok);
    robot.play();
    robot.system->run(1.5);
    robot.freeze(axis);
    robot.system->waitFor(MachineState::Faulted, 5.0);
    EXPECT_EQ(robot.system->status().fault, Fault::EncoderFrozen) << robot.system->status().fault_name;
    EXPECT_LT(height - robot.lowest, 0.005) << "axis " << axis + 1;
    robot.system->stopRecording();
    std::remove(path.c_str());
  }
}

TEST(Notices, NothingIsSaidOfARobotThatIsAsItsModelSays) {
  HoldingRobot robot(kAsModelled);
  EXPECT_EQ(robot.said(5.0), std::set<std::string>{}) << robot.last;
  robot.play();
  EXPECT_EQ(robot.said(40.0), std::set<std::string>{}) << robot.last;
}

TEST(Notices, AnUndeclaredLoadIsSaidWithItsMass) {
  HoldingRobot robot({true, 10.0, 1.0});
  robot.play();
  EXPECT_EQ(robot.said(30.0), std::set<std::string>{"something carries"}) << robot.last;
  EXPECT_NEAR(robot.system->disturbance()->load_kg, 10.0, 1.5);
}

TEST(Notices, APushIsSaidWhileItLasts) {
  HoldingRobot robot(kAsModelled);
  robot.push(100.0);
  EXPECT_EQ(robot.said(1.0), std::set<std::string>{"someone pushes, or the platform touches something:"}) << robot.last;
  robot.push(0.0);
  robot.said(5.0);
  EXPECT_EQ(robot.said(1.0), std::set<std::string>{}) << robot.last;
}

TEST(Notices, FrictionThatHasGrownByAThirdIsSaidOfItsLeg) {
  HoldingRobot robot({true, 0.0, 1.33});
  robot.play();
  robot.said(32.0);
  const Disturbance now = *robot.system->disturbance();
  EXPECT_NEAR(now.friction_growth[2], 0.33, 0.1);
  EXPECT_TRUE(now.friction_changed[2]);
  EXPECT_FALSE(now.friction_changed[0] || now.friction_changed[1] || now.friction_changed[3]);
  EXPECT_EQ(robot.last.substr(0, 32), "friction of leg 3 has grown by 3") << robot.last;
}

TEST(Notices, WithoutAModelNothingIsJudged) {
  HoldingRobot robot({false, 15.0, 1.0});
  robot.push(100.0);
  EXPECT_EQ(robot.said(3.0), std::set<std::string>{});
  EXPECT_FALSE(robot.system->disturbance()->identified);
}

/// With a patient whose file allows 60 N.
std::string patientFile() {
  const std::string path = ::testing::TempDir() + "patient_" + std::to_string(::getpid()) + ".yaml";
  std::ofstream(path) << "patient: \"17\"\n"
                         "pose: {X_m: [-0.2, 0.2], Z_m: [0.5, 0.8], theta_deg: [-20, 20], psi_deg: [-20, 20]}\n"
                         "speed: {linear_mm_per_s: 100, angular_deg_per_s: 20}\n"
                         "force: {force_N: 60}\n";
  return path;
}

TEST(PatientForce, APushBeyondThePatientsLimitStopsTheRobotAndOneWithinDoesNot) {
  for (const double push : {70.0, 200.0}) {
    HoldingRobot robot(kAsModelled);
    ASSERT_TRUE(robot.system->disable().ok);
    const Answer loaded = robot.system->loadPatient(patientFile());
    ASSERT_TRUE(loaded.ok) << loaded.sentence;
    ASSERT_TRUE(robot.system->enable().ok);
    robot.system->run(3.0);
    robot.push(push);
    robot.system->run(2.0);
    EXPECT_EQ(robot.system->status().fault, push > 100.0 ? Fault::PatientForce : Fault::None)
        << push << " N: " << robot.system->status().fault_sentence;
  }
}

TEST(PatientForce, ALimitIsRefusedWhereNoModelCouldJudgeIt) {
  HoldingRobot robot;
  ASSERT_TRUE(robot.system->disable().ok);
  const Answer loaded = robot.system->loadPatient(patientFile());
  EXPECT_FALSE(loaded.ok);
  EXPECT_NE(loaded.sentence.find("identified model"), std::string::npos) << loaded.sentence;
}

TEST(Residual, SaysTheWrenchOfAPushWithinWhatFrictionHides) {
  HoldingRobot robot(kAsModelled);
  robot.push(200.0);
  robot.system->run(1.0);
  const Disturbance now = *robot.system->disturbance();
  ASSERT_TRUE(now.known);
  EXPECT_LT(now.wrench[1], -100.0);
  EXPECT_GT(now.wrench[1], -260.0);
}

}  // namespace
}  // namespace knee_robot::control
