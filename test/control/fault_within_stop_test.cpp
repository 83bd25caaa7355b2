// The whole controller on the simulated robot A: what fails while a safe stop still slows the robot down along its path.
#include "holding_robot.h"

namespace knee_robot::control {
namespace {

using namespace holding;

struct Ending {
  ControlStatus status;
  double leg_m = 0.0, drop_m = 0.0, wrong_m = 0.0;
};

/// Swings for `time_s`, is disabled, and `bring` comes about `delay_s` later. How far any leg goes from there.
template <typename Bring>
Ending failsWhileStopping(bool model, double time_s, double delay_s, Bring&& bring) {
  Truth truth;
  truth.model = model;
  truth.payload_kg = model ? 0.0 : 15.0;
  HoldingRobot robot(truth);
  robot.swing();
  robot.system->run(time_s);
  EXPECT_EQ(robot.system->state(), MachineState::Playing) << robot.system->status().fault_sentence;
  Ending ending;
  const double begin = robot.plant.time() + delay_s;
  std::optional<simulation::PlantState> from;
  robot.system->setPlant([&](rt::Nanoseconds time) {
    while (robot.plant.time() + 0.0005 < 1e-9 * static_cast<double>(time)) {
      robot.plant.step(0.001);
      if (robot.plant.time() < begin) continue;
      if (!from) bring(robot.image.faults);
      if (!from) from = robot.plant.state();
      const mechanism::Lengths before = mechanism::legLengths(*robot.robot.mechanism, from->pose);
      ending.leg_m = std::max(ending.leg_m, (robot.plant.lengths() - before).cwiseAbs().maxCoeff());
      ending.drop_m = std::max(ending.drop_m, from->pose[1] - robot.plant.state().pose[1]);
    }
  });
  robot.system->disable();
  robot.system->run(1.0);
  ending.status = robot.system->status();
  const mechanism::Lengths said(robot.system->snapshot()->position_m.data());
  ending.wrong_m = (said - robot.plant.lengths()).cwiseAbs().maxCoeff();
  return ending;
}

template <typename Check>
void everywhere(Check&& check) {
  for (const bool model : {false, true}) {
    for (const double time_s : {0.6, 1.0, 1.7}) {
      for (const double delay_s : {0.02, 0.1, 0.2}) {
        for (std::size_t axis = 0; axis < hardware::kAxes; ++axis)
          check(model, time_s, delay_s, axis);
      }
    }
  }
}

TEST(WithinASafeStop, AnEncoderThatDiesIsFoundBeforeItsLegRunsAway) {
  double farthest = 0.0, deepest = 0.0, unsaid = 0.0;
  everywhere([&](bool model, double time_s, double delay_s, std::size_t axis) {
    const Ending ending = failsWhileStopping(model, time_s, delay_s, [axis](simulation::InjectedFaults& faults) {
      faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
    });
    // Once 377 mm and 107 mm, without a word.
    EXPECT_LT(ending.leg_m, 0.02) << "axis " << axis + 1 << ", " << delay_s << " s after disable at " << time_s;
    EXPECT_LT(ending.drop_m, 0.005) << "axis " << axis + 1 << ", " << delay_s << " s after disable at " << time_s;
    farthest = std::max(farthest, ending.leg_m);
    deepest = std::max(deepest, ending.drop_m);
    if (ending.status.homed) unsaid = std::max(unsaid, ending.wrong_m);
  });
  std::printf("a leg goes %.1f mm at most, the platform sinks by %.1f mm; wrong by %.1f mm where nobody says so\n",
              1e3 * farthest, 1e3 * deepest, 1e3 * unsaid);
  EXPECT_LT(unsaid, 0.005) << "lengths that count as known";
}

TEST(WithinASafeStop, ADriveThatFailsOrTurnsRoundIsStoppedAtOnce) {
  double deepest = 0.0;
  for (const bool reversed : {false, true}) {
    everywhere([&](bool model, double time_s, double delay_s, std::size_t axis) {
      const Ending ending = failsWhileStopping(model, time_s, delay_s, [&](simulation::InjectedFaults& faults) {
        (reversed ? faults.drive_reversed : faults.drive_dead).store(static_cast<std::uint8_t>(1u << axis));
      });
      EXPECT_LT(ending.drop_m, 0.012) << "axis " << axis + 1 << ", " << delay_s << " s after disable at " << time_s;
      deepest = std::max(deepest, ending.drop_m);  // once 31 mm
      if (reversed) {
        EXPECT_EQ(ending.status.fault_name, "runaway");
      }
    });
  }
  std::printf("the platform sinks by %.1f mm at most\n", 1e3 * deepest);
}

/// With 15 kg, at rest or swinging: axis `axis` fails at once, and the brake of `late` engages half a second late.
double dropsBehindALateBrake(bool moves, std::size_t axis, std::size_t late, bool reversed, ControlStatus& status) {
  Truth truth;
  truth.payload_kg = 15.0;
  HoldingRobot robot(truth);
  if (moves) robot.swing();
  robot.system->run(0.9);
  robot.lowest = robot.plant.state().pose[1];
  const double stood = robot.lowest;
  simulation::InjectedFaults& faults = robot.image.faults;
  faults.hold_late.store(static_cast<std::uint8_t>(1u << late));
  if (reversed) {
    faults.drive_reversed.store(static_cast<std::uint8_t>(1u << axis));
    if (!moves) robot.push(100.0);
  } else {
    faults.encoder_size_m[axis].store(0.005);
    faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Jump));
  }
  robot.system->run(2.0);
  status = robot.system->status();
  return stood - robot.lowest;
}

TEST(AFaultAtOnce, OfAnEncoderThatGoesToAndFroIsNoBrakeThatSlips) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    HoldingRobot robot{Truth{}};
    robot.swing();
    robot.system->run(1.0);
    robot.image.faults.encoder_size_m[axis].store(0.002);
    robot.image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Noise));
    robot.system->run(1.0);
    EXPECT_EQ(robot.system->state(), MachineState::Faulted)
        << "axis " << axis + 1 << ": " << robot.system->status().fault_sentence;
  }
}

TEST(BehindABrakeThatHoldsLate, AFaultAtOnceLeavesTheLoadToTheLoopsThatWork) {
  for (const bool reversed : {false, true}) {
    double deepest = 0.0, sum = 0.0;
    int runs = 0;
    for (const bool moves : {false, true}) {
      for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
        for (std::size_t other = 1; other < hardware::kAxes; ++other, ++runs) {
          ControlStatus status;
          const double drop = dropsBehindALateBrake(moves, axis, (axis + other) % hardware::kAxes, reversed, status);
          deepest = std::max(deepest, drop);
          sum += drop;
          if (drop > 0.005) {
            EXPECT_EQ(status.fault_name, "hold_device_slips") << axis + 1 << ", " << other;
          }
        }
      }
    }
    std::printf("%s: %.1f mm in the mean, %.1f mm at most\n", reversed ? "drive turns round" : "encoder jumps",
                1e3 * sum / runs, 1e3 * deepest);
    // Once 43 and 53 mm in the mean, 115 mm at most: the drives went off at once, whatever moved.
    EXPECT_LT(sum / runs, reversed ? 0.008 : 0.003);
    EXPECT_LT(deepest, reversed ? 0.03 : 0.01);
  }
}

}  // namespace
}  // namespace knee_robot::control
