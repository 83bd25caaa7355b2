// What recorders do to signals, injected one by one: each must be handled, and the report must say so.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/identify.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

constexpr double kSeconds = 50.0;

/// Two bench axes recorded at these row times; row k's force is that in the middle of its hold interval.
recording::Recording recordedAt(const std::vector<double>& times) {
  const mechanism::Robot robot = syntheticBench(2);
  const dynamics::ForceModel model(syntheticModel(robot), robot);
  const std::vector<Sines> sines = syntheticMotion(true, 0);
  dynamics::ForceModelData data;
  recording::Recording r;
  r.name = r.path = "bench.csv";
  r.axes = 2;
  r.time_s = times;
  r.position_m.resize(r.rows(), 2);
  r.force_N.resize(r.rows(), 2);
  double t = 0.0;
  for (int k = 0; k < r.rows(); ++k) {
    const double hold =
        k + 1 < r.rows() ? times[static_cast<std::size_t>(k) + 1] - times[static_cast<std::size_t>(k)] : 0.01;
    const double middle = times[static_cast<std::size_t>(k)] + hold / 2;
    mechanism::Vector4 force = mechanism::Vector4::Zero();
    for (; t <= middle; t += 0.001) {  // the friction's memory sees the whole path
      const SyntheticState s = syntheticState(robot, sines, t, kSeconds);
      dynamics::forceFromModel(model, s.q, s.v, s.a, s.motion, data, force);
    }
    r.position_m.row(k) =
        syntheticState(robot, sines, times[static_cast<std::size_t>(k)], kSeconds).q.head(2).transpose();
    r.force_N.row(k) = force.head(2).transpose();
  }
  return r;
}

std::vector<double> evenTimes() {
  std::vector<double> t;
  for (int k = 0; k < 5000; ++k)
    t.push_back(0.01 * k);
  return t;
}

struct Outcome {
  Identification id;
  std::string notes;
  Observation observation;
  double share(const std::string& reason) const {
    for (const Mask& mask : observation.masks) {
      if (mask.reason.find(reason) != std::string::npos) return mask.share;
    }
    return -1.0;
  }
};

Outcome identified(const recording::Recording& r) {
  const mechanism::Robot robot = syntheticBench(2);
  const IdentifyOptions options;
  std::vector<Observation> training = {observe(robot, columnsOf(robot), r, options.observation)};
  Outcome out;
  out.id = identify(robot, training, options);
  out.observation = training[0];
  for (const std::string& note : training[0].notes)
    out.notes += note + "\n";
  return out;
}

/// Friction and rotor within `percent` of the truth.
void expectTruth(const Outcome& out, double percent) {
  const dynamics::Model truth = syntheticModel(syntheticBench(2));
  for (const dynamics::ModelParameter& p : truth.parameters) {
    EXPECT_NEAR(parameterValue(out.id.model, p.name), p.value, percent / 100.0 * std::max(20.0, std::abs(p.value)))
        << p.name;
  }
}

void expectNote(const Outcome& out, const std::string& words) {
  EXPECT_NE(out.notes.find(words), std::string::npos) << "'" << words << "' is not in:\n" << out.notes;
}

TEST(SignalPath, TimeJitterIsResampledAway) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> late(0.0, 0.004);
  std::vector<double> times = evenTimes();
  for (double& t : times)
    t += late(random);
  const Outcome out = identified(recordedAt(times));
  expectTruth(out, 3.0);
  expectNote(out, "jitter 1.");
}

TEST(SignalPath, MissingRowsAreBridgedAndGapsAreLeftOut) {
  std::vector<double> times = evenTimes();
  times.erase(times.begin() + 3000, times.begin() + 3080);  // a gap
  times.erase(times.begin() + 1000, times.begin() + 1002);  // two rows
  const Outcome out = identified(recordedAt(times));
  expectTruth(out, 3.0);
  expectNote(out, "2 interval(s) longer than 1.5 periods, the longest 810 ms");
  expectNote(out, "lie in gaps");
  EXPECT_NEAR(out.share("gap"), 80.0 / 5000.0, 0.001);
}

TEST(SignalPath, SaturatedCommandsAreLeftOutAndTooManyAreRefused) {
  recording::Recording r = recordedAt(evenTimes());
  const Outcome clean = identified(r);
  for (int k = 2000; k < 2200; ++k)
    r.force_N(k, 1) = 1000.0;  // 10 V times 100 N/V
  const Outcome out = identified(r);
  expectTruth(out, 3.0);
  expectNote(out, "a command is at its limit");
  EXPECT_NEAR(out.share("limit"), 200.0 / 5000.0, 0.001);
  EXPECT_LT(out.id.duration_s, clean.id.duration_s);
  r.force_N.col(0).segment(1000, 1500).setConstant(-1000.0);
  try {
    identified(r);
    FAIL() << "a third is saturated";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("at its limit"), std::string::npos) << refusal.what();
  }
}

TEST(SignalPath, WhenTestPulsesTakeEverythingTheRefusalNamesThem) {
  recording::Recording r = recordedAt(evenTimes());
  r.test_pulse.setOnes(r.rows());
  try {
    identified(r);
    FAIL() << "no row may be used";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("100 % of bench.csv (test_pulse is set"), std::string::npos)
        << refusal.what();
  }
}

TEST(SignalPath, ARecordingThatNothingIsWrongWithIsWarnedOfNothing) {
  const mechanism::Robot robot = syntheticBench(2);
  const std::vector<std::string> warnings =
      warningsOf({observe(robot, columnsOf(robot), recordedAt(evenTimes()), IdentifyOptions().observation)});
  EXPECT_TRUE(warnings.empty()) << warnings.front();
}

TEST(SignalPath, AJumpOfThePositionIsNamedAndMasked) {
  recording::Recording r = recordedAt(evenTimes());
  r.position_unit = {"m", "m"};
  r.position_m.col(0).tail(2500).array() += 0.05;
  mechanism::Robot robot = syntheticBench(2);
  for (mechanism::Actuator& a : robot.actuators)
    a.velocity_max_m_per_s = 0.5;
  const IdentifyOptions options;
  std::vector<Observation> training = {observe(robot, columnsOf(robot), r, options.observation)};
  Outcome out;
  out.observation = training[0];
  for (const std::string& note : training[0].notes)
    out.notes += note + "\n";
  expectNote(out, "Line 2502: position_1_m jumps by 0.049");
  expectNote(out, "where the limit is 0.5 m/s");
  const std::vector<std::string> warnings = warningsOf(training);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("bench.csv: 0."), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("% of the samples lie in gaps"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("bench.csv: Line 2502: position_1_m jumps by 0.049"), std::string::npos) << warnings[1];
  EXPECT_LT(out.share("gap"), 0.001);
  out.id = identify(robot, training, options);
  expectTruth(out, 3.0);
}

TEST(SignalPath, ForceAtRestMeansNothingAndIsNotFitted) {
  // Between 20 s and 30 s the axes stand, and the position loop winds up and down within static friction.
  std::vector<double> times = evenTimes();
  std::vector<double> own = times;
  for (double& t : own)
    t = t < 20.0 ? t : std::max(20.0, t - 10.0);
  recording::Recording r = recordedAt(times);
  const mechanism::Robot robot = syntheticBench(2);
  const std::vector<Sines> sines = syntheticMotion(true, 0);
  for (int k = 2000; k < 3000; ++k) {
    r.position_m.row(k) = syntheticState(robot, sines, 20.0, kSeconds).q.head(2).transpose();
    for (int i = 0; i < 2; ++i)
      r.force_N(k, i) = 10.0 + 20.0 * std::sin(0.8 * k * 0.01 + i);
  }
  const recording::Recording moving = recordedAt(times);
  for (int k = 3000; k < 5000; ++k) {
    r.position_m.row(k) = moving.position_m.row(k - 1000);
    r.force_N.row(k) = moving.force_N.row(k - 1000);
  }
  const Outcome out = identified(r);
  expectTruth(out, 5.0);
  expectNote(out, "of the samples every axis is faster than 1.5 mm/s");
  EXPECT_GT(out.share("rests"), 0.2);
}

TEST(SignalPath, StaleFirstRowsAreDropped) {
  recording::Recording r = recordedAt(evenTimes());
  for (int k = 0; k < 4; ++k)
    r.position_m.row(k).setConstant(0.35);  // of the run before
  const Outcome out = identified(r);
  expectTruth(out, 3.0);
  expectNote(out, "The first 4 row(s) are stale");
}

TEST(SignalPath, EncoderStepsAreFilteredAndNamed) {
  for (const double step_m : {5e-6, 20e-6}) {
    recording::Recording r = recordedAt(evenTimes());
    r.position_m = (r.position_m / step_m).array().round() * step_m;
    const Outcome out = identified(r);
    expectTruth(out, 4.0);
    expectNote(out, step_m < 1e-5 ? "steps of 5, 5 um" : "steps of 20, 20 um");
  }
}

TEST(SignalPath, ACommandHoldsFromItsRowToTheNext) {
  // The same forces, but stamped one row late: the fit must see the difference, else it ignores when commands act.
  const recording::Recording r = recordedAt(evenTimes());
  recording::Recording late = r;
  late.force_N.bottomRows(r.rows() - 1) = r.force_N.topRows(r.rows() - 1);
  const Outcome right = identified(r), wrong = identified(late);
  expectNote(right, "commands averaged over the time they were held");
  EXPECT_GT(wrong.id.model.residual_rms_N[0], 3.0 * right.id.model.residual_rms_N[0]);
}

TEST(SignalPath, AllOfItTogetherIsSurvived) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> late(0.0, 0.003);
  std::vector<double> times = evenTimes();
  for (double& t : times)
    t += late(random);
  times.erase(times.begin() + 3500, times.begin() + 3560);
  recording::Recording r = recordedAt(times);
  r.position_m = (r.position_m / 20e-6).array().round() * 20e-6;
  for (int k = 0; k < 3; ++k)
    r.position_m.row(k).setConstant(0.35);
  for (int k = 1500; k < 1550; ++k)
    r.force_N(k, 0) = -1000.0;
  expectTruth(identified(r), 5.0);
}

}  // namespace
}  // namespace knee_robot::identification
