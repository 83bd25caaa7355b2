// What becomes of the platform when the controller dies: the guardian hands the load over to the brakes, and watches.
#include "holding_robot.h"
#include "knee_robot/control/guardian.h"
#include "knee_robot/hardware/guarded_bus.h"
#include "test/control/milliseconds.h"

namespace knee_robot::control {
namespace {

rt::Nanoseconds& handOverTime() {
  static rt::Nanoseconds time = 0;
  return time;
}
rt::Nanoseconds handOverClock() noexcept {
  return handOverTime();
}

/// What happened from the controller's death on.
struct AfterDeath {
  double leg_m = 0.0, drop_m = 0.0, on_s = 0.0;
  int slipped = 0;
};

/// A controller behind a guardian on the simulated robot A, with 15 kg that nobody declared.
struct Guarded {
  explicit Guarded(bool watches)
      : robot(mechanism::loadRobot(holding::file("config/robots/A.yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot), parameters(), image),
        cards(simulation::openImageCards(image)),
        outputs(simulation::openImageEmergencyOutputs(image)),
        bus(*cards, link, 3, options(robot, watches)),
        guardian(link, *outputs, 10 * kMs, kMs, handOverClock, {1, 4, 30 * kMs}) {
    handOverTime() = 0;
    guardian.configure();
    guardian.start();
    // The self test would wait for a guardian that runs beside it.
    EXPECT_TRUE(cards->selfTest().passed);
    link.controller_pid.store(::getpid());
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      link.slip_counts[i].store(options(robot, watches).slip_counts[i]);
    ControlSystem::Options all;
    all.empty = true;
    all.execution = rt::Execution::Stepped;
    system = std::make_unique<ControlSystem>(robot, loadHardwareFile(holding::file("config/hardware/simulated.yaml")),
                                             holding::file("config/deployment/simulation.yaml"), tested, all);
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time))
        step();
    });
    EXPECT_TRUE(system->start().ok);
    EXPECT_TRUE(system->enable().ok) << system->status().fault_sentence;
    system->run(2.0);
  }
  ~Guarded() {
    image.faults.hold_late.store(0);
    link.tripped.store(0);
  }
  static simulation::SimulationParameters parameters() {
    holding::Truth truth;
    truth.payload_kg = 15.0;
    return holding::parameters(truth);
  }
  static hardware::GuardedBus::Options options(const mechanism::Robot& robot, bool watches) {
    hardware::GuardedBus::Options all;
    all.clock = handOverClock;
    for (std::size_t i = 0; i < hardware::kAxes && watches; ++i)
      all.slip_counts[i] = static_cast<std::int32_t>(0.0005 / robot.actuators[i].metresPerCount()) + 1;
    return all;
  }
  /// 80 mm to and fro in X within 2.4 s.
  void swing() const {
    const mechanism::Pose home = plant.state().pose;
    const mechanism::Lengths stands(system->snapshot()->reference_m.data());
    const mechanism::Lengths beside = stands - mechanism::legLengths(*robot.mechanism, home);
    trajectory::Reference reference;
    reference.name = "swing";
    reference.points.resize(481, 4);
    for (int k = 0; k <= 480; ++k) {
      mechanism::Pose pose = home;
      pose[0] += 0.04 * (1.0 - std::cos(2.0 * M_PI * k / 240));
      reference.points.row(k) = (mechanism::legLengths(*robot.mechanism, pose) + beside).transpose();
    }
    ASSERT_TRUE(system->loadReference(reference).ok);
    ASSERT_TRUE(system->play().ok);
  }
  void step() {
    plant.step(0.001);
    handOverTime() += kMs;
    guardian.update({handOverTime(), handOverTime(), kMs});
  }
  /// The controller does not cycle any more.
  AfterDeath dies() {
    AfterDeath after;
    const mechanism::Lengths stood = plant.lengths();
    const double height = plant.state().pose[1];
    for (int k = 0; k < 4000; ++k) {
      step();
      after.leg_m = std::max(after.leg_m, (plant.lengths() - stood).cwiseAbs().maxCoeff());
      after.drop_m = std::max(after.drop_m, height - plant.state().pose[1]);
      if ((image.counter.outputs.load() & 1) != 0) after.on_s = 0.001 * (k + 1);
    }
    EXPECT_EQ(image.counter.outputs.load() & 3, 0) << "off in the end, whatever moves";
    after.slipped = guardian.report().slipped.load();
    return after;
  }

  /// The bus without its self test.
  struct Tested : hardware::AxisBus {
    explicit Tested(hardware::AxisBus& bus) : bus_(bus) {}
    hardware::SelfTest selfTest() override { return {true, {}}; }
    hardware::IoStatus read(hardware::AxisFeedback& feedback) noexcept override { return bus_.read(feedback); }
    hardware::IoStatus writeVolts(const std::array<double, kAxes>& volts,
                                  std::array<double, kAxes>& written) noexcept override {
      return bus_.writeVolts(volts, written);
    }
    hardware::IoStatus writeOutputs(std::uint8_t bits) noexcept override { return bus_.writeOutputs(bits); }
    bool isFencedOut() const noexcept override { return bus_.isFencedOut(); }
    bool isGuarded() const noexcept override { return true; }
    void offerLoad(const std::array<double, kAxes>* volts) noexcept override { bus_.offerLoad(volts); }
    hardware::AxisBus& bus_;
  };

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  hardware::GuardianLink link;
  std::unique_ptr<hardware::AxisBus> cards;
  std::unique_ptr<hardware::EmergencyOutputs> outputs;
  hardware::GuardedBus bus;
  Tested tested{bus};
  Guardian guardian;
  std::unique_ptr<ControlSystem> system;
};

TEST(AControllerThatDies, IsCarriedUntilBrakesThatEngageLateHold) {
  for (const bool watches : {false, true}) {
    double deepest = 0.0, farthest = 0.0, longest = 0.0;
    for (const std::uint8_t late : {1, 2, 4, 8, 15}) {
      Guarded robot(watches);
      robot.image.faults.hold_late.store(late);
      const AfterDeath after = robot.dies();
      deepest = std::max(deepest, after.drop_m);
      farthest = std::max(farthest, after.leg_m);
      longest = std::max(longest, after.on_s);
      if (!watches) continue;
      EXPECT_LT(after.drop_m, 0.01) << "once 10 to 170 mm, brakes " << static_cast<int>(late);
      EXPECT_LT(after.on_s, 1.2);
      EXPECT_NE(after.slipped, 0);
    }
    std::printf("%s: a leg goes %.1f mm, the platform sinks by %.1f mm, drives on for %.2f s\n",
                watches ? "watched" : "for the brakes' time", 1e3 * farthest, 1e3 * deepest, longest);
  }
}

/// No brake can be ordered: 0 V would let the platform fall by its whole stroke.
TEST(AControllerThatDies, IsCarriedAsLongAsTheCounterCardIsGone) {
  for (const simulation::CardLoss loss : {simulation::kCardGone, simulation::kCardSilent}) {
    for (const bool before : {true, false}) {
      Guarded robot(true);
      const auto drops_m_in = [&](double seconds) {
        const double height = robot.plant.state().pose[1];
        double deepest = height;
        for (int k = 0; k < static_cast<int>(1000.0 * seconds); ++k) {
          robot.step();
          deepest = std::min(deepest, robot.plant.state().pose[1]);
        }
        return height - deepest;
      };
      robot.system->run(4.0);         // until what carries at rest is known
      if (!before) drops_m_in(0.02);  // the guardian carries already
      robot.image.counter.disconnected.store(loss);
      if (before) robot.system->run(0.5);
      const double drop_m = drops_m_in(3.0);
      EXPECT_LT(drop_m, 0.01) << int{loss} << (before ? " before" : " after") << ": once 420 mm";
      EXPECT_EQ(robot.guardian.report().written.load(), !before);
      EXPECT_TRUE(robot.guardian.report().acts.load());
      robot.image.counter.disconnected.store(0);
      const AfterDeath after = robot.dies();
      EXPECT_LT(after.drop_m, 0.005) << "the card is back: its brakes engage";
      EXPECT_LT(after.on_s, 1.2);
      std::printf("sinks by %.1f mm in 3 s, then by %.1f mm\n", 1e3 * drop_m, 1e3 * after.drop_m);
    }
  }
}

TEST(AControllerThatDies, IsNotPushedOnBlindlyWhereTheCounterCardWentInMotion) {
  Guarded robot(true);
  robot.swing();
  robot.system->run(0.9);
  robot.image.counter.disconnected.store(simulation::kCardGone);
  robot.system->run(0.1);
  for (int k = 0; k < 200; ++k)
    robot.step();
  for (const double volts : simulation::outputVolts(robot.image.analog))
    EXPECT_EQ(volts, 0.0);
}

TEST(AControllerThatDies, InTheMiddleOfAMotionIsCarriedToRest) {
  double deepest = 0.0;
  for (const std::uint8_t late : {0, 1, 4, 8, 15}) {
    for (const double time_s : {0.5, 0.9, 1.3}) {
      Guarded robot(true);
      robot.swing();
      robot.system->run(time_s);
      robot.image.faults.hold_late.store(late);
      const AfterDeath after = robot.dies();
      deepest = std::max(deepest, after.drop_m);
      EXPECT_LT(after.on_s, 1.2) << static_cast<int>(late);
      if (late == 0) {
        EXPECT_LT(after.on_s, 0.5);
      }
    }
  }
  std::printf("the platform sinks by %.1f mm at most\n", 1e3 * deepest);
  EXPECT_LT(deepest, 0.04) << "once 129 mm";
}

TEST(AControllerThatDies, HasItsDrivesOffSoonWhereTheBrakesHold) {
  Guarded robot(true);
  const AfterDeath after = robot.dies();
  EXPECT_EQ(after.slipped, 0);
  EXPECT_LT(after.drop_m, 0.001);
  EXPECT_NEAR(after.on_s, 0.01 + 0.03 + 0.38, 0.005);
}

TEST(AControllerThatDies, LeavesNothingOnForEverWhereNoBrakeEngages) {
  Guarded robot(true);
  robot.image.faults.hold_open.store(15);
  const AfterDeath after = robot.dies();
  std::printf("on for %.2f s, a leg goes %.1f mm\n", after.on_s, 1e3 * after.leg_m);
  EXPECT_LT(after.on_s, 2.2);
  EXPECT_NE(after.slipped, 0);
}

}  // namespace
}  // namespace knee_robot::control
