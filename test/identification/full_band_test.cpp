#include "knee_robot/identification/full_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/identify.h"
#include "knee_robot/identification/prediction.h"
#include "knee_robot/recording/cutoff.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

constexpr double kRate_hz = 1000.0, kFastNoise_N = 2.0;

/// A ball-screw axis of 80 kg that is driven with up to 8 Hz: friction tanh(v / 0.7 mm/s), encoder of `count_m`, no
/// reference column.
recording::Recording fastAxis(double seconds, double count_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kFastNoise_N);
  recording::Recording r;
  r.name = r.path = "axis_" + std::to_string(seed) + ".csv";
  r.axes = 1;
  const int rows = static_cast<int>(seconds * kRate_hz);
  r.position_m.resize(rows, 1);
  r.force_N.resize(rows, 1);
  const double hz[] = {0.4, 1.3, 4.1, 6.2, 7.9};
  for (int k = 0; k < rows; ++k) {
    const double t = k / kRate_hz;
    double x = 0.3, v = 0.0, a = 0.0;
    for (int h = 0; h < 5; ++h) {
      const double w = 2.0 * M_PI * hz[h], size = 0.06 / w, phase = 1.7 * h + seed;
      x += size * std::sin(w * t + phase);
      v += size * w * std::cos(w * t + phase);
      a -= size * w * w * std::sin(w * t + phase);
    }
    r.time_s.push_back(t);
    r.position_m(k, 0) = count_m * std::round(x / count_m);
    r.force_N(k, 0) = 80.0 * a + 300.0 * v + 40.0 * std::tanh(v / 7e-4) + 12.0 + noise(random);
  }
  return r;
}

mechanism::Robot axis(double count_m) {
  mechanism::Robot robot = syntheticBench(1);
  robot.actuators[0].screw_lead_m = 0.01;
  robot.actuators[0].counts_per_revolution = 0.01 / count_m;
  return robot;
}

/// Error of a held-out recording's rows in % of their rms.
struct Errors {
  double rows = 0.0, filtered = 0.0, cutoff_hz = 0.0, motion_hz = 0.0;
};

Errors identified(double count_m) {
  const mechanism::Robot robot = axis(count_m);
  const recording::Recording train = fastAxis(20.0, count_m, 1), other = fastAxis(15.0, count_m, 2);
  IdentifyOptions options;
  options.uncertainty = false;
  const recording::CutoffChoice cutoff = recording::chooseCutoff({&train});
  std::printf("%s\n", cutoff.sentence.c_str());
  options.observation.setCutoff(cutoff.cutoff_hz);
  const std::vector<Column> columns = columnsOf(robot);
  std::vector<Observation> training = {observe(robot, columns, train, options.observation)};
  const Identification id = identify(robot, training, options);
  const RowPredictor predict = [&](Observation& o, int) { return predictForce(id.model, robot, o.signals, o.motion); };
  const FullBand band = chooseFullBand(robot, columns, {train}, options.observation, predict);
  std::printf("%s\n", band.sentence.c_str());
  const std::vector<Observation> validation = {observe(robot, columns, other, options.observation)};
  Applied applied = applyModel(id.model, robot, validation, cutoff.cutoff_hz);
  Errors e;
  e.filtered = applied.accuracy.rms_percent[0];
  if (band.motion_cutoff_hz > 0.0)
    applied.predictions[0].row_force_N =
        predictRows(robot, columns, other, options.observation, band.motion_cutoff_hz, predict, -1);
  e.rows = accuracyOf(validation, applied.predictions).raw_percent[0];
  e.cutoff_hz = cutoff.cutoff_hz;
  e.motion_hz = band.motion_cutoff_hz;
  std::printf("held out: full band %.2f %%, fit's band %.2f %%\n", e.rows, e.filtered);
  return e;
}

TEST(FullBand, AnAxisDrivenWithUpTo8HzAt1KhzIsPredictedWithAllOfIt) {
  const Errors e = identified(1e-6);
  EXPECT_GT(e.cutoff_hz, 12.0);
  EXPECT_LT(e.filtered, 3.0);
  EXPECT_LT(e.rows, 5.0) << "noise alone is 2 % of the force";
}

TEST(FullBand, CoarseEncodersEndTheBand) {
  const Errors fine = identified(1e-6), coarse = identified(20e-6);
  EXPECT_GT(coarse.motion_hz, 8.0);
  EXPECT_LT(coarse.motion_hz, 0.5 * fine.motion_hz);
  EXPECT_LT(coarse.rows, 8.0);
}

TEST(FullBand, OfASlowRecordingIsThatOfTheFitWhenNothingIsGained) {
  const mechanism::Robot robot = syntheticRobot();
  const dynamics::Model model = syntheticModel(robot);
  const recording::Recording r = syntheticRecording(robot, model, 0, 20.0);
  ObservationOptions options;
  options.setCutoff(3.0);
  // A prediction that does not look at the motion cannot gain by seeing more of it.
  const FullBand band = chooseFullBand(
      robot, columnsOf(robot), {r}, options,
      [&](Observation& o, int) -> Eigen::MatrixXd { return Eigen::MatrixXd::Constant(o.samples(), 4, 5.0); });
  EXPECT_EQ(band.motion_cutoff_hz, 0.0);
  EXPECT_GT(band.tried_hz.size(), 2u);
}

}  // namespace
}  // namespace knee_robot::identification
