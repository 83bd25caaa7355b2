#include "knee_robot/recording/jumps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/recording/signals.h"

namespace knee_robot::recording {
namespace {

const std::vector<double> kFastest = {0.5};  ///< m/s

/// One axis at 100 Hz, 30 s, at most 0.16 m/s.
Recording swinging() {
  Recording r;
  r.path = "swinging.csv";
  r.axes = 1;
  r.position_m.resize(3000, 1);
  r.force_N.setConstant(3000, 1, 20.0);
  for (int k = 0; k < 3000; ++k) {
    r.time_s.push_back(0.01 * k);
    r.position_m(k, 0) = 0.7 + 0.05 * std::sin(M_PI * 0.01 * k);
  }
  return r;
}

void jumpBy(Recording& r, int row, double step_m) {
  r.position_m.bottomRows(r.rows() - row).array() += step_m;
}

TEST(Jumps, AStepThatNoMotionMakesIsFoundWithItsRowSizeAndSpeed) {
  Recording r = swinging();
  EXPECT_TRUE(findJumps(r, 0, kFastest).empty());
  jumpBy(r, 1500, 0.05);
  const std::vector<Jump> jumps = findJumps(r, 0, kFastest);
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_EQ(jumps[0].row, 1500);
  EXPECT_NEAR(jumps[0].beyond_m, 0.05, 2e-5) << "without the axis' own motion";
  EXPECT_NEAR(jumps[0].m_per_s, 5.0, 0.2);
  EXPECT_EQ(jumps[0].frozen_s, 0.0);
  EXPECT_TRUE(findJumps(r, 0, {0.0}).empty()) << "nobody knows how fast the axis is";
}

TEST(Jumps, OneOddRowIsTwoOfThem) {
  Recording r = swinging();
  r.position_m(1500, 0) += 0.05;
  EXPECT_EQ(findJumps(r, 0, kFastest).size(), 2u);
}

TEST(Jumps, AMotionThatIsFastForLongIsNone) {
  Recording r = swinging();
  r.position_m *= 1000.0;  // millimetres in a column of metres: something else is wrong
  EXPECT_TRUE(findJumps(r, 0, kFastest).empty());
}

TEST(Jumps, ASlowEncodersHeldValueIsNone) {
  Recording r;
  r.axes = 1;
  r.position_m.resize(10000, 1);
  for (int k = 0; k < 10000; ++k) {  // 1 kHz, a new value every 10 ms: 3 mm in a millisecond
    r.time_s.push_back(1e-3 * k);
    r.position_m(k, 0) = 0.1 * std::sin(3.0 * 1e-2 * std::floor(k / 10.0));
  }
  EXPECT_TRUE(findJumps(r, 0, {0.3}).empty());
}

TEST(Jumps, StampsInBurstsAndCoarseStepsAreNone) {
  Recording r = swinging();
  for (int k = 0; k < r.rows(); ++k)
    r.time_s[static_cast<std::size_t>(k)] = 0.03 * std::floor(k / 3.0) + 1e-5 * (k % 3);
  EXPECT_TRUE(findJumps(r, 0, kFastest).empty());
  r = swinging();
  r.position_m = (r.position_m / 6e-3).array().round() * 6e-3;  // 0.6 m/s in one step
  EXPECT_TRUE(findJumps(r, 0, kFastest).empty());
}

TEST(Jumps, AFrozenEncoderIsToldByTheJumpWithWhichItLetsGo) {
  Recording r = swinging();
  r.position_m.middleRows(1000, 350).setConstant(r.position_m(1000, 0));
  const std::vector<Jump> jumps = findJumps(r, 0, kFastest);
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_EQ(jumps[0].row, 1350);
  EXPECT_NEAR(jumps[0].frozen_s, 3.49, 1e-9);
  EXPECT_NEAR(jumps[0].from_s, 10.0, 1e-9);
  r.position_m.middleRows(2000, 300).setConstant(r.position_m(2000, 0));  // it rests elsewhere, too
  jumpBy(r, 2300, r.position_m(2000, 0) - r.position_m(2300, 0));         // and goes on from there
  ASSERT_EQ(findJumps(r, 0, kFastest).size(), 1u);
  EXPECT_EQ(findJumps(r, 0, kFastest)[0].frozen_s, 0.0) << "it may have rested here as well";
}

TEST(Resample, AJumpDoesNotSpread) {
  Recording r = swinging();
  SignalOptions options;
  options.fastest_m_per_s = kFastest;
  const Signals whole = resample(r, r.force_N, options);
  EXPECT_EQ(std::count(whole.gap.begin(), whole.gap.end(), 1), 0);
  jumpBy(r, 1500, 0.05);
  const Signals s = resample(r, r.force_N, options);
  ASSERT_EQ(s.samples(), whole.samples());
  int gaps = 0;
  for (int n = 0; n < s.samples(); ++n) {
    gaps += s.gap[static_cast<std::size_t>(n)];
    EXPECT_EQ(s.known[static_cast<std::size_t>(n)], !s.gap[static_cast<std::size_t>(n)]);
    EXPECT_NEAR(s.acceleration_m_per_s2(n, 0), whole.acceleration_m_per_s2(n, 0), 0.05);
    EXPECT_NEAR(s.position_m(n, 0), whole.position_m(n, 0) + (s.time_s[n] >= 15.0 ? 0.05 : 0.0), 1e-4);
  }
  EXPECT_GE(gaps, 1);
  EXPECT_LE(gaps, 3);
}

}  // namespace
}  // namespace knee_robot::recording
