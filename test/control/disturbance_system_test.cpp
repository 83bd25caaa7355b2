// The whole controller on the simulated robot A, stepped. At rest nobody is shaken while nothing happens, and a push
// finds a dead encoder.
// With a model it says who pushes, what is carried, whose friction has changed, and whether the model still holds.
#include "holding_robot.h"

namespace knee_robot::control {
namespace {

using namespace holding;

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

TEST(Disturbance, DeclaringAPayloadAtRestPushesNobody) {
  HoldingRobot robot;
  AxisValues before = robot.system->snapshot()->force_N;
  ASSERT_TRUE(robot.system->setProperty("Feedforward", "payload_kg", "10").ok);
  double largest_N = 0.0;
  for (int k = 0; k < 4000; ++k) {
    robot.system->step();
    const AxisValues now = robot.system->snapshot()->force_N;
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      largest_N = std::max(largest_N, std::abs(now[i] - before[i]));
    before = now;
  }
  EXPECT_LT(largest_N, 5.0) << "from one cycle to the next";
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

TEST(Notices, ThatThereAreNoneIsSaidWithTheReason) {
  Disturbance now;
  EXPECT_EQ(std::string(sentenceWithoutNotices(now)).substr(0, 10), "not judged");
  now.identified = true;
  EXPECT_EQ(std::string(sentenceWithoutNotices(now)).substr(0, 13), "not evaluated");
  now.known = true;
  EXPECT_EQ(std::string(sentenceWithoutNotices(now)).substr(0, 12), "nothing acts");
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

TEST(PatientForce, IsJudgedThroughoutAnOrdinarySession) {
  HoldingRobot robot(kAsModelled);
  ASSERT_TRUE(robot.system->disable().ok);
  ASSERT_TRUE(robot.system->loadPatient(patientFile()).ok);
  double longest_unjudged_s = 0.0, unjudged_s = 0.0;
  const auto run = [&](double seconds) {
    for (int k = 0; k < static_cast<int>(1000 * seconds); ++k) {
      robot.system->step();
      unjudged_s = robot.system->disturbance()->known ? 0.0 : unjudged_s + 0.001;
      longest_unjudged_s = std::max(longest_unjudged_s, unjudged_s);
    }
  };
  for (int session = 0; session < 2; ++session) {
    ASSERT_TRUE(robot.system->enable().ok);
    run(3.0);
    robot.play(300);
    run(2.0);
    ASSERT_TRUE(robot.system->pause().ok);
    run(2.0);
    ASSERT_TRUE(robot.system->resume().ok);
    run(2.0);
    ASSERT_TRUE(robot.system->stop().ok);
    run(2.0);
    ASSERT_TRUE(robot.system->disable().ok);
    unjudged_s = 0.0;
  }
  EXPECT_EQ(robot.system->status().fault, Fault::None) << robot.system->status().fault_sentence;
  EXPECT_LT(longest_unjudged_s, 0.5);
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
