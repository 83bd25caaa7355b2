// Homing against the ends of the strokes on the simulated robot A, and what comes between: what the robot believes then.
#include <random>

#include "holding_robot.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

/// Stands 12 mm above home and does not know it.
struct UnknownPlace {
  explicit UnknownPlace(const std::string& name = "final", const std::vector<int>& order = {4, 1, 2, 3},
                        double below_m = 0.0)
      : robot(robotOf(name, below_m)),
        plant(robot, dynamics::loadRobotInertia(robot), parameters(robot, name), image),
        bus(simulation::openImageCards(image)) {
    HardwareFile hardware = loadHardwareFile(holding::file("config/hardware/simulated.yaml"));
    hardware.homing.method = HomingMethod::HardStop;
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      HomingAxis& axis = hardware.homing.axes[i];
      axis.length_m = robot.actuators[i].position_min_m - 0.005;  // SimulationParameters::stop_margin_m
      axis.speed_m_per_s = 0.02;
      axis.force_N = i == 3 ? 150.0 : 60.0;
      axis.travel_m = 0.3;
      hardware.homing.order[i] = order[i];
    }
    ControlSystem::Options options;
    options.empty = true;
    options.execution = rt::Execution::Stepped;
    system = std::make_unique<ControlSystem>(robot, hardware, holding::file("config/deployment/simulation.yaml"), *bus,
                                             options);
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time)) {
        plant.step(0.001);
        look();
      }
    });
    EXPECT_TRUE(system->start().ok);
  }
  /// With stops so far below home; 0: where the robot file has them.
  static mechanism::Robot robotOf(const std::string& name, double below_m) {
    mechanism::Robot robot = mechanism::loadRobot(holding::file("config/robots/" + name + ".yaml"));
    for (auto& actuator : robot.actuators) {
      if (below_m > 0.0) actuator.position_min_m = actuator.home_length_m - below_m;
    }
    return robot;
  }
  static simulation::SimulationParameters parameters(const mechanism::Robot& robot, const std::string& name) {
    holding::Truth truth;
    truth.robot = name;
    simulation::SimulationParameters all = holding::parameters(truth);
    mechanism::Lengths home;
    for (int i = 0; i < 4; ++i)
      home[i] = robot.actuators[static_cast<std::size_t>(i)].home_length_m;
    mechanism::Pose pose = mechanism::forwardKinematicsFromHome(*robot.mechanism, home).pose;
    pose[1] += 0.012;
    all.start_lengths_m = mechanism::legLengths(*robot.mechanism, pose);
    return all;
  }
  /// Outputs that no state may have.
  void look() {
    const std::uint8_t outputs = image.counter.outputs.load();
    alone = alone || (outputs & 3) == 2;
    if (!watched) return;
    if (!from) from = plant.lengths();
    farthest_m = std::max(farthest_m, (plant.lengths() - *from).cwiseAbs().maxCoeff());
  }
  void spoil(std::size_t axis, simulation::EncoderFault fault) {
    image.faults.encoder_size_m[axis].store(0.005);
    image.faults.encoder[axis].store(static_cast<std::uint8_t>(fault));
  }
  double wrong_m() const {
    const mechanism::Lengths said(system->snapshot()->position_m.data());
    return (said - plant.lengths()).cwiseAbs().maxCoeff();
  }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  std::unique_ptr<hardware::AxisBus> bus;
  bool alone = false;  // brakes open, drives off
  bool watched = false;
  std::optional<mechanism::Lengths> from;
  double farthest_m = 0.0;
  std::unique_ptr<ControlSystem> system;
};

/// What comes between.
struct Interruption {
  const char* name;
  std::function<void(UnknownPlace&, const std::string& patient)> happens;
  bool dead = false;  // an encoder: what its axis then does is another test
};

const std::vector<Interruption>& interruptions() {
  static const std::vector<Interruption> all = {
      {"stop", [](UnknownPlace& place, const std::string&) { place.system->stop(); }},
      {"disable", [](UnknownPlace& place, const std::string&) { place.system->disable(); }},
      {"emergency stop", [](UnknownPlace& place, const std::string&) { place.system->emergencyStop(); }},
      {"emergency stop button",
       [](UnknownPlace& place, const std::string&) { place.image.surroundings.emergency_stop_pressed.store(1); }},
      {"hand switch",
       [](UnknownPlace& place, const std::string&) { place.image.surroundings.hand_switch_pressed.store(1); }},
      {"guide", [](UnknownPlace& place, const std::string&) { EXPECT_FALSE(place.system->guide().ok); }},
      {"home", [](UnknownPlace& place, const std::string&) { place.system->home(); }},
      {"confirm home", [](UnknownPlace& place, const std::string&) { EXPECT_FALSE(place.system->confirmHome().ok); }},
      {"enable", [](UnknownPlace& place, const std::string&) { place.system->enable(); }},
      {"patient",
       [](UnknownPlace& place, const std::string& patient) {
         const bool off = place.system->state() == MachineState::Disabled;
         EXPECT_EQ(place.system->loadPatient(patient).ok, off);
       }},
      {"pause and speed",
       [](UnknownPlace& place, const std::string&) {
         place.system->pause();
         place.system->setSpeed(0.0);
       }},
      {"encoder 1", [](UnknownPlace& place, const std::string&) { place.spoil(0, simulation::EncoderFault::Frozen); },
       true},
      {"encoder 3", [](UnknownPlace& place, const std::string&) { place.spoil(2, simulation::EncoderFault::Frozen); },
       true},
      {"encoder 4", [](UnknownPlace& place, const std::string&) { place.spoil(3, simulation::EncoderFault::Frozen); },
       true},
      {"encoder 2 jumps",
       [](UnknownPlace& place, const std::string&) { place.spoil(1, simulation::EncoderFault::Jump); }},
      {"encoder 4 interrupted",
       [](UnknownPlace& place, const std::string&) { place.spoil(3, simulation::EncoderFault::Interrupted); }, true},
      {"drive 1 dead", [](UnknownPlace& place, const std::string&) { place.image.faults.drive_dead.store(1); }},
      {"supply of encoders and drives",
       [](UnknownPlace& place, const std::string&) {
         for (std::size_t i = 0; i < hardware::kAxes; ++i)
           place.spoil(i, simulation::EncoderFault::Interrupted);
         place.image.faults.drive_dead.store(15);
         place.image.surroundings.emergency_stop_pressed.store(1);
       }},
      {"brakes late",
       [](UnknownPlace& place, const std::string&) {
         place.image.faults.hold_late.store(15);
         place.system->disable();
       }},
  };
  return all;
}

/// How far any leg goes from the interruption on.
double goesOn(const Interruption& one, double after_s, const std::string& patient) {
  UnknownPlace place("A", {4, 1, 2, 3}, 0.02);
  EXPECT_TRUE(place.system->home().ok);
  place.system->run(after_s);
  one.happens(place, patient);
  place.watched = true;
  place.system->waitFor(MachineState::Disabled, 40.0);
  place.watched = false;
  simulation::clear(place.image.faults);
  place.system->run(0.2);
  const ControlStatus now = place.system->status();
  const std::string where = one.name + (" after " + std::to_string(after_s)) + " s: " + now.fault_sentence;
  EXPECT_FALSE(place.alone) << where;
  const bool off = now.state == MachineState::Disabled || now.state == MachineState::Faulted;
  if (off) {
    EXPECT_EQ(place.image.counter.outputs.load() & 3, 0) << where;
  }
  if (now.homed) {
    EXPECT_LT(place.wrong_m(), 0.001) << where;
  }
  return place.farthest_m;
}

TEST(HomingAtTheStops, InterruptedAtAnyMomentKnowsNoWrongHome) {
  const TemporaryFolder folder;
  const std::string patient = folder + "/p17.yaml";
  writeFileAtomically(patient,
                      "patient: \"17\"\n"
                      "pose: {X_m: [-0.1, 0.1], Z_m: [0.5, 0.7], theta_deg: [-20, 20], psi_deg: [-20, 20]}\n");
  std::mt19937 random(5);
  double farthest = 0.0;
  for (const Interruption& one : interruptions()) {
    for (int k = 0; k < 4; ++k) {
      const double after_s = std::uniform_real_distribution<double>(0.0, 18.5)(random);
      const double leg_m = goesOn(one, after_s, patient);
      if (one.dead) farthest = std::max(farthest, leg_m);
    }
  }
  std::printf("with a dead encoder a leg goes %.1f mm at most\n", 1e3 * farthest);
  EXPECT_LT(farthest, 0.045) << "once 412 mm: nobody asked encoders that were not homed";
}

TEST(HomingAtTheStops, FindsThemOnHealthyRobotsAndOnceMore) {
  for (const std::string name : {"A", "final"}) {
    for (const std::vector<int>& order : {std::vector<int>{4, 1, 2, 3}, {4, 3, 1, 2}, {4, 2, 3, 1}}) {
      UnknownPlace place(name, order, 0.03);
      for (int k = 0; k < 2; ++k) {  // the second time with soft limits that the stops lie beyond
        ASSERT_TRUE(place.system->home().ok);
        place.system->run(0.1);
        EXPECT_TRUE(place.system->waitFor(MachineState::Disabled, 60.0)) << place.system->status().fault_sentence;
        place.system->run(0.1);
        EXPECT_TRUE(place.system->status().homed) << name;
        EXPECT_LT(place.wrong_m(), 0.001) << name;
      }
    }
  }
}

/// A plan that passes a fold of the mechanism: axis 3 stands there as at its stop.
TEST(HomingAtTheStops, IsRefusedWhereAnAxisWouldPassASingularity) {
  int refused = 0;
  for (const std::string name : {"A", "final"}) {
    std::vector<int> order = {1, 2, 3, 4};
    do {
      try {
        UnknownPlace place(name, order);  // with the stops of its robot file
        ADD_FAILURE() << name << ", order " << order[0] << order[1] << order[2] << order[3];
      } catch (const InputError& error) {
        const std::string why = error.what();
        refused += why.find("near a singularity") != std::string::npos ? 1 : 0;
      }
    } while (std::next_permutation(order.begin(), order.end()));
  }
  EXPECT_EQ(refused, 48) << "once 23 of them ended `homed`, lengths wrong by 10 to 57 mm";
}

}  // namespace
}  // namespace knee_robot::control
