// The whole controller on the simulated robot A behind a guardian, stepped; and what becomes of it when that dies.
#pragma once

#include "holding_robot.h"
#include "knee_robot/control/guardian.h"
#include "knee_robot/hardware/guarded_bus.h"
#include "test/control/milliseconds.h"

namespace knee_robot::control::guarded {

inline rt::Nanoseconds& handOverTime() {
  static rt::Nanoseconds time = 0;
  return time;
}
inline rt::Nanoseconds handOverClock() noexcept {
  return handOverTime();
}

/// What happened from the controller's death on.
struct AfterDeath {
  double leg_m = 0.0, drop_m = 0.0, on_s = 0.0;
  int slipped = 0;
};

/// A controller behind a guardian on the simulated robot A, with 15 kg that nobody declared.
struct Guarded {
  explicit Guarded(bool watches, const std::string& deployment = "")
      : robot(mechanism::loadRobot(holding::file("config/robots/A.yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot), parameters(), image),
        cards(simulation::openImageCards(image)),
        outputs(simulation::openImageEmergencyOutputs(image)),
        bus(*cards, link, 3, options()),
        tested(bus, watches) {
    handOverTime() = 0;
    startGuardian();
    // The self test would wait for a guardian that runs beside it.
    EXPECT_TRUE(cards->selfTest().passed);
    link.controller_pid.store(::getpid());
    ControlSystem::Options all;
    all.empty = true;
    all.execution = rt::Execution::Stepped;
    system = std::make_unique<ControlSystem>(
        robot, loadHardwareFile(holding::file("config/hardware/simulated.yaml")),
        deployment.empty() ? holding::file("config/deployment/simulation.yaml") : deployment, tested, all);
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
  static hardware::GuardedBus::Options options() {
    hardware::GuardedBus::Options all;
    all.clock = handOverClock;
    return all;
  }
  /// In place of one that has died, where there was one.
  void startGuardian() {
    guardian = std::make_unique<Guardian>(link, *outputs, 10 * kMs, kMs, handOverClock, GuardianCarry{1, 4, 30 * kMs});
    guardian->configure();
    guardian->start();
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
    if (guardian) guardian->update({handOverTime(), handOverTime(), kMs});
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
    after.slipped = guardian->report().slipped.load();
    return after;
  }

  /// The bus without its self test.
  struct Tested : hardware::AxisBus {
    Tested(hardware::AxisBus& bus, bool watches) : bus_(bus), watches_(watches) {}
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
    void watchBrakes(const hardware::BrakeWatch& watch) noexcept override {
      if (watches_) bus_.watchBrakes(watch);
    }
    bool isCarriedByGuardian() const noexcept override { return bus_.isCarriedByGuardian(); }
    hardware::AxisBus& bus_;
    const bool watches_;
  };

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  hardware::GuardianLink link;
  std::unique_ptr<hardware::AxisBus> cards;
  std::unique_ptr<hardware::EmergencyOutputs> outputs;
  hardware::GuardedBus bus;
  Tested tested;
  std::unique_ptr<Guardian> guardian;
  std::unique_ptr<ControlSystem> system;
};

}  // namespace knee_robot::control::guarded
