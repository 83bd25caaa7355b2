// Effects of gears on an arm of two joints, by laws that share no code with trace: each is named where it was hidden,
// and an arm without any stays clean.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "knee_robot/identification/recording_units.h"
#include "knee_robot/tracing/trace.h"
#include "test/identification/chain_motion.h"

namespace knee_robot::tracing {
namespace {

using identification::GearLoss;

/// Names and actuators that trace adds to a recording with this loss. `change`: what else is done to the recording.
std::vector<std::string> namesOf(const GearLoss& loss,
                                 const std::function<void(recording::Recording&)>& change = nullptr) {
  mechanism::Robot robot = identification::testArm(
      "joints: [{name: waist, locked_at_rad: 0.3}, {name: rail, locked_at_m: 0.1}, "
      "{name: shoulder}, {name: elbow}]\ngravity_m_per_s2: [3.0, 0, -9.0]\n");
  std::vector<recording::Recording> recordings;
  std::mt19937 dice(7);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (const int seed : {1, 2}) {
    recordings.push_back(identification::armRecording(robot, seed, 1.0, loss));
    recordings.back().force_N = recordings.back().force_N.unaryExpr([&](double f) { return f + noise(dice); });
    if (change) change(recordings.back());
  }
  identification::adaptToRecordings(robot, recordings);
  std::vector<identification::Observation> training;
  TraceOptions options;
  options.fast_band = false;
  options.maps = false;
  options.observation.setCutoff(3.0);
  for (recording::Recording& r : recordings) {
    identification::toActuatorUnits(robot, r);
    training.push_back(identification::observe(robot, identification::columnsOf(robot), r, options.observation));
  }
  std::vector<std::string> names;
  for (const FoundEffect& e : trace(robot, recordings, training, options).effects) {
    names.push_back(e.hypothesis.place.candidate->name() + " " + std::to_string(e.hypothesis.place.actuator));
    std::cout << "found " << names.back() << "\n";
  }
  return names;
}

TEST(GearEffects, AnArmWithoutAnyStaysClean) {
  EXPECT_EQ(namesOf(nullptr), std::vector<std::string>());
}

TEST(GearEffects, RippleAtOneTwoAndFourTimesAPeriodIsNamed) {
  const GearLoss ripple = [](int joint, double, double q, double, double) {
    const double phase = 2.0 * M_PI * q / 0.21;
    return joint == 1 ? 1.2 * std::sin(phase) + 0.9 * std::sin(2 * phase + 1.0) + 0.6 * std::cos(4 * phase) : 0.0;
  };
  EXPECT_EQ(namesOf(ripple), std::vector<std::string>{"gear_ripple 1"});
}

TEST(GearEffects, TorsionalHysteresisIsNamed) {
  double last = 0.0, z = 0.0;  // Bouc and Wen's law
  int before = -1;
  const GearLoss hysteresis = [&](int joint, double t, double, double, double load) {
    if (joint != 0) return 0.0;
    if (t == 0.0 || before < 0) z = 0.0, last = load;
    before = 0;
    const double d = (load - last) / 8.0;
    last = load;
    z += d - 0.5 * (std::abs(d) * z * std::abs(z) + d * z * z);
    return 3.0 * z;
  };
  EXPECT_EQ(namesOf(hysteresis), std::vector<std::string>{"torsional_hysteresis 0"});
}

TEST(GearEffects, FrictionThatFollowsARecordedTemperatureIsNamed) {
  const auto celsius = [](double t) {
    return 30.0 + 8.0 * std::sin(0.9 * t);
  };  // faster than any drive: no time constant fits
  const GearLoss warm = [&](int joint, double t, double, double v, double) {
    return joint == 1 ? -0.06 * (celsius(t) - 25.0) * std::tanh(v / 0.005) : 0.0;
  };
  const auto names = namesOf(warm, [&](recording::Recording& r) {
    r.temperature_degC.resize(r.rows(), r.axes);
    for (int k = 0; k < r.rows(); ++k)
      r.temperature_degC.row(k).setConstant(celsius(r.time_s[static_cast<std::size_t>(k)]));
  });
  EXPECT_EQ(names, std::vector<std::string>{"temperature_dependent_friction 1"});
}

TEST(GearEffects, AGearThatGivesIsSeenByTwoEncoders) {
  // The motor runs ahead of the joint by a winding of its own; its inertia counts.
  const auto wound = [](double t) { return 0.004 * std::sin(2.0 * M_PI * 1.7 * t + 0.4); };
  const GearLoss rotor = [](int joint, double t, double, double, double) {
    const double w = 2.0 * M_PI * 1.7;
    return joint == 0 ? -2.5 * 0.004 * w * w * std::sin(w * t + 0.4) : 0.0;
  };
  const auto names = namesOf(rotor, [&](recording::Recording& r) {
    r.motor_m = r.position_m;
    for (int k = 0; k < r.rows(); ++k)
      r.motor_m(k, 0) += wound(r.time_s[static_cast<std::size_t>(k)]);
  });
  EXPECT_EQ(names, std::vector<std::string>{"joint_elasticity 0"});
}

}  // namespace
}  // namespace knee_robot::tracing
