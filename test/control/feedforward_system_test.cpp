// The whole controller with its feedforward on the simulated robot A, stepped: take-over, tracking, and faults that it
// must not hide.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "some_model.h"
#include "test/refusal.h"

namespace knee_robot::control {
namespace {

std::string file(const std::string& name) {
  return std::string(KNEE_SOURCE_DIR) + "/" + name;
}

/// The last two close a loop through the model.
enum class Feedforward { None, Weights, Model, ComputedTorque, PassivityBased };

/// The product's deployment with a property of its feedforward.
std::string deploymentWith(const std::string& property) {
  std::string text = readFile(file("config/deployment/simulation.yaml"));
  const std::string line = "type: ModelFeedforward, activity: servo";
  text.insert(text.find(line) + line.size(), ", properties: {" + property + "}");
  const std::string path = ::testing::TempDir() + "feedforward_deployment_" + std::to_string(::getpid()) + ".yaml";
  writeFileAtomically(path, text);
  return path;
}

struct ForwardedRig {
  explicit ForwardedRig(Feedforward feedforward, double payload_kg = 0.0, double declared_kg = 0.0)
      : robot(mechanism::loadRobot(file("config/robots/A.yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot), parameters(payload_kg), image),
        bus(simulation::openImageCards(image)) {
    ControlSystem::Options options;
    options.empty = true;
    options.execution = rt::Execution::Stepped;
    options.payload_kg = declared_kg;
    const std::string path = ::testing::TempDir() + "feedforward_system_test_" + std::to_string(::getpid()) + ".yaml";
    std::string deployment = file("config/deployment/simulation.yaml");
    if (feedforward == Feedforward::ComputedTorque) deployment = deploymentWith("law: computed_torque");
    if (feedforward == Feedforward::PassivityBased) deployment = deploymentWith("law: passivity_based");
    if (feedforward >= Feedforward::Model) {
      dynamics::saveModel(fake::modelOf(robot, 150.0, 15.0, 60.0), path);
      options.model = path;
    }
    system = std::make_unique<ControlSystem>(robot, loadHardwareFile(file("config/hardware/simulated.yaml")),
                                             deployment, *bus, options);
    std::remove(path.c_str());
    if (feedforward > Feedforward::Model) std::remove(deployment.c_str());
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time))
        plant.step(0.001);
      look();
    });
    started = system->start();
    if (feedforward == Feedforward::None) system->setProperty("Feedforward", "share_gravity", "0");
  }
  static simulation::SimulationParameters parameters(double payload_kg) {
    simulation::SimulationParameters all = simulation::loadSimulationParameters(file("config/simulation/A.yaml"));
    if (payload_kg > 0.0) all.payload = simulation::Payload{payload_kg, {0.0, 0.0, 0.1}, 0.1};
    return all;
  }
  void look() {
    const std::optional<TrackingRow> row = system->snapshot();
    if (!row) return;
    const bool released = (row->digital_outputs >> 1 & 1) != 0;
    if (released && !released_) at_release = *row;
    released_ = released;
    lowest = std::min(lowest, plant.state().pose[1]);
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      largest_error[i] = std::max(largest_error[i], std::abs(row->reference_m[i] - row->position_m[i]));
  }
  /// Up and down by 60 mm every 8 s, at 23 mm/s where it is fastest; turning points at 4, 8, 12 s.
  void play() {
    ASSERT_TRUE(system->enable().ok);
    trajectory::Reference reference;
    reference.name = "up_and_down";
    const mechanism::Pose home = plant.state().pose;
    reference.points.resize(1601, 4);
    for (int k = 0; k <= 1600; ++k) {
      mechanism::Pose pose = home;
      pose[1] += 0.03 * (1.0 - std::cos(2.0 * M_PI * k / 800.0));
      reference.points.row(k) = mechanism::legLengths(*robot.mechanism, pose).transpose();
    }
    const Answer loaded = system->loadReference(reference);
    ASSERT_TRUE(loaded.ok) << loaded.sentence;
    const Answer moved = system->approach();
    ASSERT_TRUE(moved.ok) << moved.sentence;
    ASSERT_TRUE(system->waitFor(MachineState::Holding, 10.0));
    const Answer played = system->play();
    ASSERT_TRUE(played.ok) << played.sentence;
    largest_error = {};
  }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  std::unique_ptr<hardware::AxisBus> bus;
  Answer started;
  std::optional<TrackingRow> at_release;
  double lowest = 1.0;
  AxisValues largest_error{};

 private:
  bool released_ = false;

 public:
  std::unique_ptr<ControlSystem> system;  // last: it goes on stepping the plant while it shuts down
};

TEST(TakeOver, OpensTheHoldDevicesOntoAForceThatAlreadyCarriesTheRobot) {
  for (const double payload_kg : {0.0, 15.0}) {
    ForwardedRig rig(Feedforward::Weights, payload_kg, payload_kg);
    ASSERT_TRUE(rig.started.ok) << rig.started.sentence;
    const double height = rig.plant.state().pose[1];
    ASSERT_TRUE(rig.system->enable().ok);
    rig.system->run(1.0);
    ASSERT_TRUE(rig.at_release.has_value());
    EXPECT_GT(rig.at_release->force_N[3], 50.0) << "with the release, not after it";
    EXPECT_NEAR(rig.at_release->force_N[3], rig.at_release->feedforward_N[3], 2.0);
    EXPECT_LT(height - rig.lowest, 1e-4);
    EXPECT_EQ(rig.system->state(), MachineState::Holding);
  }
}

TEST(TakeOver, OfAPayloadThatNobodyDeclaredSinksLessThanWithoutFeedforward) {
  double sinks[2];
  for (const bool with : {false, true}) {
    ForwardedRig rig(with ? Feedforward::Weights : Feedforward::None, 15.0);
    ASSERT_TRUE(rig.started.ok);
    const double height = rig.plant.state().pose[1];
    ASSERT_TRUE(rig.system->enable().ok);
    rig.system->run(1.0);
    EXPECT_EQ(rig.system->state(), MachineState::Holding) << rig.system->status().fault_sentence;
    sinks[with] = height - rig.lowest;
  }
  std::printf("15 kg sink by %.2f mm without feedforward, by %.2f mm undeclared\n", 1e3 * sinks[0], 1e3 * sinks[1]);
  EXPECT_LT(sinks[1], 0.6 * sinks[0]);
}

TEST(Reversals, AreFollowedMoreCloselyWithAModelOfTheFriction) {
  AxisValues largest[3];
  for (const Feedforward kind : {Feedforward::None, Feedforward::Weights, Feedforward::Model}) {
    ForwardedRig rig(kind);
    ASSERT_NO_FATAL_FAILURE(rig.play());
    ASSERT_TRUE(rig.system->waitFor(MachineState::Holding, 20.0)) << rig.system->status().fault_sentence;
    AxisValues& error = largest[static_cast<int>(kind)];
    error = rig.largest_error;
    std::printf("largest errors, mm: %.2f %.2f %.2f %.2f\n", 1e3 * error[0], 1e3 * error[1], 1e3 * error[2],
                1e3 * error[3]);
  }
  EXPECT_LT(largest[2][3], 0.7 * largest[0][3]);
}

/// A fault in the middle of the motion, or around a turning point.
struct Case {
  const char* what;
  void (*inject)(simulation::InjectedFaults&, std::size_t axis);
  std::vector<Fault> names;
  double longest_s,
      deepest_m;  // half as much again as was measured: what is left of the time and of the drop may not grow
};

void freeze(simulation::InjectedFaults& faults, std::size_t axis) {
  faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
}
void turn(simulation::InjectedFaults& faults, std::size_t axis) {
  faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::WrongSign));
}
void kill(simulation::InjectedFaults& faults, std::size_t axis) {
  faults.drive_dead.store(static_cast<std::uint8_t>(1u << axis));
}
void reverse(simulation::InjectedFaults& faults, std::size_t axis) {
  faults.drive_reversed.store(static_cast<std::uint8_t>(1u << axis));
}
void block(simulation::InjectedFaults& faults, std::size_t axis) {
  faults.hold_closed.store(static_cast<std::uint8_t>(1u << axis));
}

class HiddenFault : public ::testing::TestWithParam<Feedforward> {};

TEST_P(HiddenFault, IsFoundWithFeedforwardAsWithout) {
  const std::vector<Case> cases = {
      {"encoder frozen",
       freeze,
       {Fault::EncoderFrozen, Fault::Runaway, Fault::FollowingError, Fault::Stalled},
       1.4,
       0.05},
      {"encoder counts backwards", turn, {Fault::Runaway, Fault::FollowingError, Fault::EncoderFrozen}, 0.55, 0.005},
      {"drive without power",
       kill,
       {Fault::Runaway, Fault::AxisBlocked, Fault::FollowingError, Fault::EncoderFrozen, Fault::Stalled,
        Fault::Saturated},
       2.5,
       0.023},
      {"drive reversed", reverse, {Fault::Runaway, Fault::FollowingError, Fault::AccelerationLimit}, 0.3, 0.009},
      {"brake closed",
       block,
       {Fault::AxisBlocked, Fault::EncoderFrozen, Fault::FollowingError, Fault::Stalled},
       2.2,
       0.011}};
  for (const Case& one : cases) {
    for (const std::size_t axis : {std::size_t{0}, std::size_t{3}}) {
      for (const double when : {2.0, 3.8, 4.1}) {
        ForwardedRig rig(GetParam());
        ASSERT_NO_FATAL_FAILURE(rig.play());
        rig.system->run(when);
        ASSERT_EQ(rig.system->state(), MachineState::Playing);
        rig.lowest = rig.plant.state().pose[1];
        const double height = rig.lowest, begin = rig.plant.time();
        one.inject(rig.image.faults, axis);
        rig.system->waitFor(MachineState::Faulted, 5.0);
        const ControlStatus status = rig.system->status();
        std::printf("%-26s axis %zu at %.1f s: %-18s faulted after %4.0f ms, %.1f mm below\n", one.what, axis + 1, when,
                    status.fault_name.c_str(), 1e3 * (rig.plant.time() - begin), 1e3 * (height - rig.lowest));
        EXPECT_NE(std::find(one.names.begin(), one.names.end(), status.fault), one.names.end()) << status.fault_name;
        EXPECT_LT(rig.plant.time() - begin, one.longest_s) << one.what;
        // Computed torque drives leg 4 harder by its larger share of the mass, a reversed one into the wrong direction
        // too.
        const bool harder = GetParam() == Feedforward::ComputedTorque && one.inject == reverse;
        EXPECT_LT(height - rig.lowest, harder ? 0.023 : one.deepest_m) << one.what;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Feedforward, HiddenFault,
                         ::testing::Values(Feedforward::None, Feedforward::Weights, Feedforward::Model,
                                           Feedforward::ComputedTorque, Feedforward::PassivityBased));

TEST(ControlLaws, FollowReversalsAsCloselyAsTheFeedforwardWhereTheyArePassive) {
  ForwardedRig with(Feedforward::Model), passive(Feedforward::PassivityBased), torque(Feedforward::ComputedTorque);
  for (ForwardedRig* rig : {&with, &passive, &torque}) {
    ASSERT_TRUE(rig->started.ok) << rig->started.sentence;
    ASSERT_NO_FATAL_FAILURE(rig->play());
    ASSERT_TRUE(rig->system->waitFor(MachineState::Holding, 20.0)) << rig->system->status().fault_sentence;
    const AxisValues& error = rig->largest_error;
    std::printf("largest errors, mm: %.2f %.2f %.2f %.2f\n", 1e3 * error[0], 1e3 * error[1], 1e3 * error[2],
                1e3 * error[3]);
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    EXPECT_LT(passive.largest_error[i], 1.1 * with.largest_error[i]) << "axis " << i + 1;
  // Computed torque is softer where little mass is: it loses here, within what the monitors bear.
  for (const double error : torque.largest_error)
    EXPECT_LT(error, 1e-3);
}

TEST(ControlLaws, AreRefusedInOneSentenceThatNamesFileAndProperty) {
  const auto refusal = [](const std::string& property, const std::string& gains) {
    ForwardedRig rig(Feedforward::Model);
    const std::string path = deploymentWith(property);
    std::string text = readFile(path);
    if (!gains.empty()) text.replace(text.find("integral_N_per_m_s: 300000"), 26, gains);
    writeFileAtomically(path, text);
    const std::string model = path + ".model.yaml";
    dynamics::saveModel(fake::modelOf(rig.robot), model);
    ControlSystem::Options options;
    options.execution = rt::Execution::Stepped;
    if (property.find("feedforward") == std::string::npos) options.model = model;
    const std::string said = refusalOf([&] {
      ControlSystem system(rig.robot, loadHardwareFile(file("config/hardware/simulated.yaml")), path, *rig.bus,
                           options);
    });
    std::remove(path.c_str());
    std::remove(model.c_str());
    EXPECT_EQ(said.find(path), said.empty() ? std::string::npos : 0u) << said;
    return said;
  };
  EXPECT_EQ(refusal("law: passivity_based", ""), "");
  EXPECT_NE(refusal("law: slotine", "").find("Feedforward.law: there is no law slotine"), std::string::npos);
  EXPECT_NE(refusal("law: passivity_based, lambda_per_s: 90", "").find("between 5.85786 and 34.1421, not at 90"),
            std::string::npos);
  EXPECT_NE(refusal("law: passivity_based", "integral_N_per_m_s: 900000").find("gains of Driver1"), std::string::npos);
}

TEST(ControlLaws, NeedAModel) {
  ForwardedRig rig(Feedforward::Weights);
  const std::string path = deploymentWith("law: computed_torque");
  ControlSystem::Options options;
  options.execution = rt::Execution::Stepped;
  const std::string said = refusalOf([&] {
    ControlSystem system(rig.robot, loadHardwareFile(file("config/hardware/simulated.yaml")), path, *rig.bus, options);
  });
  EXPECT_NE(said.find("computed_torque needs an identified model"), std::string::npos) << said;
  std::remove(path.c_str());
}

TEST(TracedDelay, IsRefusedWhereItsLoopWouldBeUnstable) {
  ForwardedRig rig(Feedforward::Model);
  const auto refusal = [&](double delay_s, bool of_controller) {
    const std::string path = ::testing::TempDir() + "delayed_" + std::to_string(::getpid()) + ".yaml";
    dynamics::Model model = fake::tracedModelOf(rig.robot, {fake::delayOf(2, delay_s)});
    if (of_controller) {
      model.feedforward =
          dynamics::ModelFeedforward{{model.effects_see, model.effects_see, model.effects}, model.friction};
      model.effects.clear();
    }
    dynamics::saveModel(model, path);
    ControlSystem::Options options;
    options.execution = rt::Execution::Stepped;
    options.model = path;
    const std::string said = refusalOf([&] {
      ControlSystem system(rig.robot, loadHardwareFile(file("config/hardware/simulated.yaml")),
                           file("config/deployment/simulation.yaml"), *rig.bus, options);
    });
    std::remove(path.c_str());
    return said;
  };
  for (const bool of_controller : {false, true}) {
    EXPECT_EQ(refusal(0.002, of_controller), "");
    const std::string said = refusal(0.025, of_controller);
    EXPECT_NE(said.find("axis 2 acts 25 ms late"), std::string::npos) << said;
    EXPECT_NE(said.find("Driver2 is unstable from"), std::string::npos) << said;
    std::printf("%s\n", said.c_str());
  }
}

TEST(ControlLaws, RefuseGainsAtRunTimeWithWhichTheyWouldNotBePassive) {
  ForwardedRig rig(Feedforward::PassivityBased);
  ASSERT_TRUE(rig.started.ok) << rig.started.sentence;
  EXPECT_TRUE(rig.system->setProperty("Driver2", "integral_N_per_m_s", "250000").ok);
  const Answer refused = rig.system->setProperty("Driver2", "proportional_N_per_m", "30000");
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("Driver2"), std::string::npos) << refused.sentence;
}

}  // namespace
}  // namespace knee_robot::control
