// Nobody knows what the motion was in a gap: no figure may count what is predicted there.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/identify.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

struct Judged {
  std::vector<Observation> observed;
  Applied applied;
  Identification id;
};

/// Bench axes with noise on their forces.
recording::Recording noisyBench() {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 2.0);
  const mechanism::Robot robot = syntheticBench(2);
  return syntheticRecording(robot, syntheticModel(robot), 0, 40.0, [&] { return noise(random); });
}

void removeRows(recording::Recording& r, int from, int count) {
  const int after = r.rows() - from - count;
  for (Eigen::MatrixXd* m : {&r.position_m, &r.force_N}) {
    m->middleRows(from, after) = m->bottomRows(after).eval();
    m->conservativeResize(from + after, Eigen::NoChange);
  }
  r.time_s.erase(r.time_s.begin() + from, r.time_s.begin() + from + count);
}

/// Fitted to the whole recording, applied to `r`.
Judged judge(const recording::Recording& r) {
  const mechanism::Robot robot = syntheticBench(2);
  const IdentifyOptions options;
  Judged out;
  std::vector<Observation> training = {observe(robot, columnsOf(robot), noisyBench(), options.observation)};
  out.id = identify(robot, training, options);
  out.observed = {observe(robot, columnsOf(robot), r, options.observation)};
  setFriction(out.observed[0], out.id.columns, out.id.model.friction);
  out.applied = applyModel(out.id.model, robot, out.observed, options.observation.cutoff_hz);
  return out;
}

TEST(GapAccuracy, AGapChangesNoFigureBeyondTheSamplesItTakes) {
  const Judged whole = judge(noisyBench());
  EXPECT_EQ(whole.applied.accuracy.samples, whole.observed[0].samples());
  for (const int rows : {30, 1000}) {
    recording::Recording r = noisyBench();
    removeRows(r, 1500, rows);
    const Judged gap = judge(r);
    const Accuracy &a = gap.applied.accuracy, &w = whole.applied.accuracy;
    ASSERT_EQ(gap.observed[0].samples(), whole.observed[0].samples());
    EXPECT_LT(a.samples, w.samples - rows);
    EXPECT_GT(a.samples, w.samples - rows - 80) << "the low-pass reaches a third of a second to either side";
    EXPECT_LT(a.moving_samples, w.moving_samples);
    for (Eigen::Index i = 0; i < 2; ++i) {
      EXPECT_NEAR(a.rms_N[i], w.rms_N[i], 0.2 * w.rms_N[i]) << rows;
      EXPECT_NEAR(a.rms_moving_N[i], w.rms_moving_N[i], 0.2 * w.rms_moving_N[i]) << rows;
      EXPECT_NEAR(a.rms_raw_N[i], w.rms_raw_N[i], 0.2 * w.rms_raw_N[i]) << rows;
      EXPECT_LE(a.max_N[i], 1.05 * w.max_N[i]) << rows;
    }
    const Eigen::VectorXd curve = errorAgainstRank(gap.id, gap.observed, 3.0).back();
    EXPECT_LT(curve[0], 1.2 * errorAgainstRank(whole.id, whole.observed, 3.0).back()[0]) << rows;
  }
}

TEST(GapAccuracy, AFewMissingRowsAreNoGapAndOtherMasksTakeNothingAway) {
  recording::Recording r = noisyBench();
  removeRows(r, 1500, 2);
  r.force_N.block(800, 0, 100, 1).setConstant(1000.0);  // at its limit: masked, and compared all the same
  const Judged few = judge(r);
  EXPECT_EQ(few.observed[0].judgedSamples(), few.observed[0].samples());
  EXPECT_EQ(few.applied.accuracy.samples, few.observed[0].samples());
  EXPECT_GT(few.observed[0].saturated_share, 0.0);
}

TEST(GapAccuracy, ARecordingThatIsAllGapsHasNoFigures) {
  Judged all = judge(noisyBench());
  std::fill(all.observed[0].judged.begin(), all.observed[0].judged.end(), 0);
  const Accuracy a = accuracyOf(all.observed, all.applied.predictions);
  EXPECT_EQ(a.samples, 0);
  EXPECT_TRUE(std::isnan(a.rms_N[0]));
}

}  // namespace
}  // namespace knee_robot::identification
