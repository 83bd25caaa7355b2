#include "src/identification/clipped_force.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "test/identification/observe_one.h"

namespace knee_robot::identification {
namespace {

/// Two bench axes whose limits are 1000 N.
recording::Recording benchOf() {
  const mechanism::Robot robot = syntheticBench(2);
  return syntheticRecording(robot, syntheticModel(robot), 0, 40.0);
}

Observation observed(const recording::Recording& r) {
  return observeOne(syntheticBench(2), r, {}).front();
}

/// `share` of the largest force of an axis.
double shareOf(const recording::Recording& r, int axis, double share) {
  return share * r.force_N.col(axis).cwiseAbs().maxCoeff();
}

TEST(ClippedForce, IsMaskedAndSaidWhereItStandsAtItsOwnExtreme) {
  recording::Recording r = benchOf();
  EXPECT_EQ(observed(r).clipped, "");
  EXPECT_EQ(observed(r).saturated_share, 0.0);
  const double limit = shareOf(r, 1, 0.8);
  const auto beyond = (r.force_N.col(1).array().abs() > limit).count();
  r.force_N.col(1) = r.force_N.col(1).cwiseMax(-limit).cwiseMin(limit);
  const Observation o = observed(r);
  EXPECT_EQ(o.clipped.find("force_2_N stands at "), 0u) << o.clipped;
  EXPECT_NEAR(o.saturated_share, static_cast<double>(beyond) / r.rows(), 0.02);
  EXPECT_TRUE(std::any_of(o.notes.begin(), o.notes.end(), [](const std::string& note) {
    return note.find("it is cut off there, below the robot file's limit") != std::string::npos;
  }));
}

TEST(ClippedForce, OnOneSideAloneIsFoundToo) {
  recording::Recording r = benchOf();
  r.force_N.col(0) = r.force_N.col(0).cwiseMin(shareOf(r, 0, 0.7));
  EXPECT_EQ(observed(r).clipped.find("force_1_N stands at "), 0u) << observed(r).clipped;
}

TEST(ClippedForce, TooMuchOfItIsRefusedWithItsValue) {
  recording::Recording r = benchOf();
  r.force_N.col(1) = r.force_N.col(1).cwiseMax(-20.0).cwiseMin(20.0);
  std::vector<Observation> training = {observed(r)};
  try {
    identify(syntheticBench(2), training, {});
    FAIL() << "most of it is cut off";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("at its limit (force_2_N stands at -20 and 20 N"), std::string::npos)
        << refusal.what();
  }
}

TEST(ClippedForce, IsNotWhatCoarseStepsStandingAxesAndCommandedStepsLookLike) {
  recording::Recording r = benchOf();
  r.force_N = (r.force_N / 10.0).array().round() * 10.0;
  EXPECT_EQ(observed(r).clipped, "") << "coarse steps";
  r = benchOf();
  for (const int from : {1000, 2000}) {  // it stands twice, and is held by its largest force
    r.position_m.bottomRows(r.rows() - from).rowwise() -= r.position_m.row(from + 300) - r.position_m.row(from);
    for (int k = from; k < from + 300; ++k)
      r.position_m.row(k) = r.position_m.row(from + 300);
    r.force_N.middleRows(from + 50, 200).setConstant(shareOf(r, 1, 1.0));
  }
  EXPECT_EQ(observed(r).clipped, "") << "it stands";
  r = benchOf();
  for (int k = 0; k < r.rows(); ++k)
    r.force_N.row(k).setConstant((k / 100) % 2 ? 40.0 : -40.0);
  EXPECT_EQ(observed(r).clipped, "") << "steps of force are commanded";
}

}  // namespace
}  // namespace knee_robot::identification
