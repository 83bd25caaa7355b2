#include "knee_robot/identification/motion_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/dynamics/friction_law.h"
#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/identify.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

constexpr double kPeriod_s = 1e-3, kBristle_m = 50e-6;

/// An axis of 20 kg on bristles of 50 um that stands every other second, where it is nudged to and fro by 60 um within
/// hundredths of a second, to one side or the other.
recording::Recording nudgedAxis(double count_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.3);
  const int rows = 24000;
  std::vector<double> x(rows);
  double way = 0.0;
  for (int k = 0; k < rows; ++k) {
    const double t = k * kPeriod_s, within = std::fmod(t, 2.0);
    const double speed = (std::fmod(t, 8.0) < 4.0 ? 1.0 : -1.0) * (0.02 + 0.001 * seed);
    if (within < 1.0) way += kPeriod_s * speed * std::pow(std::sin(M_PI * within), 2);
    const double side = std::fmod(t, 4.0) < 2.0 ? 1.0 : -1.0, since_nudge_s = within - 1.4;
    x[static_cast<std::size_t>(k)] = 0.2 + way + 60e-6 * side * std::exp(-std::pow(since_nudge_s / 0.012, 2));
  }
  recording::Recording r;
  r.name = r.path = "axis_" + std::to_string(seed) + ".csv";
  r.axes = 1;
  r.position_m.resize(rows - 2, 1);
  r.force_N.resize(rows - 2, 1);
  const dynamics::FrictionLaw law = dynamics::bristleLaw(kBristle_m);
  dynamics::FrictionState state;
  for (std::size_t k = 0; k + 2 < x.size(); ++k) {
    const double v = (x[k + 1] - x[k]) / kPeriod_s, a = (x[k + 2] - 2.0 * x[k + 1] + x[k]) / (kPeriod_s * kPeriod_s);
    const Eigen::Index row = static_cast<Eigen::Index>(k);
    r.time_s.push_back(static_cast<double>(k) * kPeriod_s);
    r.position_m(row, 0) = count_m * std::round(x[k] / count_m);
    r.force_N(row, 0) = 20.0 * a + 150.0 * v + 30.0 * state.step(law, x[k + 1] - x[k], kPeriod_s) + noise(random);
  }
  return r;
}

mechanism::Robot axisCountedIn(double count_m) {
  mechanism::Robot robot = syntheticBench(1);
  robot.actuators[0].screw_lead_m = 0.01;
  robot.actuators[0].counts_per_revolution = 0.01 / count_m;
  return robot;
}

/// rms N of an axis on recordings that its model was not fitted to.
double errorOn(const mechanism::Robot& robot, const std::vector<recording::Recording>& other,
               const std::vector<recording::Recording>& train, const IdentifyOptions& options) {
  const std::vector<Column> columns = columnsOf(robot);
  std::vector<Observation> training = observeAll(robot, columns, train, options.observation);
  const Identification id = identify(robot, training, options);
  return applyModel(id.model, robot, observeAll(robot, columns, other, options.observation),
                    options.observation.cutoff_hz)
      .accuracy.rms_N[0];
}

struct Chosen {
  MotionBand band;
  double as_fitted_N = 0.0, wider_N = 0.0;  ///< held-out error of the fit's band
};

Chosen chosenFor(double count_m) {
  const mechanism::Robot robot = axisCountedIn(count_m);
  const std::vector<Column> columns = columnsOf(robot);
  const std::vector<recording::Recording> train = {nudgedAxis(count_m, 1)}, other = {nudgedAxis(count_m, 2)};
  IdentifyOptions options;
  options.uncertainty = false;
  options.observation.setCutoff(3.0);
  const auto heldOut = [&] { return errorOn(robot, other, train, options); };
  Chosen c;
  c.band = chooseMotionBand(robot, columns, train, observeAll(robot, columns, train, options.observation),
                            options.observation);
  c.as_fitted_N = heldOut();
  if (c.band.cutoff_hz == 0.0) return c;
  options.observation.setCutoff(3.0, c.band.cutoff_hz);
  c.wider_N = heldOut();
  return c;
}

TEST(MotionBand, IsWiderWhereFrictionFollowsMotionsThatAreFasterThanTheFitAndTheEncoderSeesThem) {
  const Chosen c = chosenFor(1e-6);
  std::printf("%s\nheld out: %.2f -> %.2f N\n", c.band.sentence.c_str(), c.as_fitted_N, c.wider_N);
  EXPECT_GT(c.band.cutoff_hz, 29.0);
  EXPECT_LT(c.wider_N, 0.3 * c.as_fitted_N);
}

TEST(MotionBand, IsThatOfTheRuleWhereTheEncoderIsCoarse) {
  EXPECT_EQ(chosenFor(20e-6).band.cutoff_hz, 0.0);
}

/// An axis of 20 kg that rubs by tanh(v / 0.15 mm/s), moves every other four seconds, and creeps by 0.02 mm/s between;
/// its encoder counts 5 um, and trembles.
recording::Recording creepingAxis(unsigned seed) {
  constexpr double kRow_s = 4e-3, kCount_m = 5e-6;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.2), trembles(0.0, 1.5e-6);
  recording::Recording r;
  r.name = r.path = "creeping_" + std::to_string(seed) + ".csv";
  r.axes = 1;
  const Eigen::Index rows = 12000;
  r.position_m.resize(rows, 1);
  r.force_N.resize(rows, 1);
  double way = 0.2;
  const double cycle_s = 8.0 + 0.3 * seed;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double t = kRow_s * static_cast<double>(row), within = std::fmod(t, cycle_s), half = 0.5 * cycle_s;
    const double side = std::fmod(t, 2.0 * cycle_s) < cycle_s ? 1.0 : -1.0, w = 2.0 * M_PI / half;
    const double v = within < half ? side * 0.01 * (1.0 - std::cos(w * within)) : -side * 2e-5;
    const double a = within < half ? side * 0.01 * w * std::sin(w * within) : 0.0;
    r.time_s.push_back(t);
    r.position_m(row, 0) = kCount_m * std::round((way + trembles(random)) / kCount_m);
    way += kRow_s * v;
    r.force_N(row, 0) = 20.0 * a + 150.0 * v + 30.0 * std::tanh(v / 1.5e-4) + noise(random);
  }
  return r;
}

TEST(MotionBand, OfSmoothLawsIsTheShortestLineWithinAnEncodersStepsWhereThatTellsRestFromTrembling) {
  const mechanism::Robot robot = axisCountedIn(5e-6);
  const std::vector<Column> columns = columnsOf(robot);
  const std::vector<recording::Recording> train = {creepingAxis(1)}, other = {creepingAxis(2)};
  IdentifyOptions options;
  options.uncertainty = false;
  options.observation.setCutoff(10.0);
  const auto heldOut = [&] { return errorOn(robot, other, train, options); };
  const MotionBand band = chooseMotionBand(robot, columns, train,
                                           observeAll(robot, columns, train, options.observation), options.observation);
  EXPECT_GE(band.taut_steps, 1.0);
  const double as_low_passed_N = heldOut();
  options.observation.taut_steps = band.taut_steps;
  const double taut_N = heldOut();
  std::printf("%s\nheld out: %.2f -> %.2f N\n", band.sentence.c_str(), as_low_passed_N, taut_N);
  EXPECT_LT(taut_N, 0.7 * as_low_passed_N);
}

TEST(MotionBand, WhatWasFittedOnTheWayIsWhatWouldBeFittedAgain) {
  const mechanism::Robot robot = axisCountedIn(5e-6);
  const std::vector<Column> columns = columnsOf(robot);
  const std::vector<recording::Recording> train = {creepingAxis(1)};
  IdentifyOptions options;
  options.uncertainty = false;
  options.observation.setCutoff(10.0);
  const std::vector<Observation> as_low_passed = observeAll(robot, columns, train, options.observation);
  const MotionBand band = chooseMotionBand(robot, columns, train, as_low_passed, options.observation);
  ASSERT_NE(band.fit, nullptr);
  options.observation.taut_steps = band.taut_steps;
  std::vector<Observation> training = observeAll(robot, columns, train, options.observation), again = training;
  const Identification anew = identify(robot, training, options);
  options.laws_of = band.fit;
  const Identification of_its_laws = identify(robot, again, options);
  EXPECT_EQ(band.fit->parameters, anew.parameters);
  EXPECT_EQ(of_its_laws.parameters, anew.parameters);
  EXPECT_EQ(again.front().regressor.front(), training.front().regressor.front());
}

TEST(MotionBand, OfBristlesIsNeverThatLine) {
  EXPECT_EQ(chosenFor(1e-6).band.taut_steps, 0.0);
  EXPECT_EQ(chosenFor(20e-6).band.taut_steps, 0.0);
}

}  // namespace
}  // namespace knee_robot::identification
