#include "knee_robot/recording/test_pulses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/recording/signals.h"

namespace knee_robot::recording {
namespace {

/// 10 s at 1 kHz; 20 N, and a pulse of 200 N from 4 s for 10 ms.
Recording pushed() {
  Recording r;
  r.path = "pushed.csv";
  r.axes = 1;
  constexpr int kRows = 10'000;
  r.position_m.resize(kRows, 1);
  r.force_N.setConstant(kRows, 1, 20.0);
  r.test_pulse.setZero(kRows);
  for (int k = 0; k < kRows; ++k) {
    r.time_s.push_back(1e-3 * k);
    r.position_m(k, 0) = 0.7 + 0.05 * std::sin(1e-3 * k);
  }
  r.force_N.middleRows(4000, 10).setConstant(220.0);
  r.test_pulse.segment(4000, 10).setConstant(1.0);
  return r;
}

TEST(TestPulses, AreBridgedAndMarkedUntilTheRobotRests) {
  Recording r = pushed();
  bridgeTestPulses(r);
  EXPECT_NEAR(r.force_N.maxCoeff(), 20.0, 1e-9);
  EXPECT_NEAR(r.test_pulse.sum(), 60.0, 1.1) << "10 ms, and 50 ms after";
  EXPECT_EQ(r.test_pulse[3999], 0.0);
  ASSERT_EQ(r.notes.size(), 1u);
  EXPECT_NE(r.notes[0].find("0.59 % of the rows"), std::string::npos) << r.notes[0];
}

TEST(TestPulses, MakeSamplesThatNobodyKnows) {
  Recording r = pushed();
  bridgeTestPulses(r);
  const Signals s = resample(r, r.force_N, {});
  int unknown = 0;
  for (int n = 0; n < s.samples(); ++n) {
    if (s.known[static_cast<std::size_t>(n)]) continue;
    ++unknown;
    EXPECT_NEAR(s.time_s[static_cast<std::size_t>(n)], 4.03, 0.035);
  }
  EXPECT_GT(unknown, 2);
}

TEST(TestPulses, AtTheEndsOfARecordingTheForceBesideThemIsKept) {
  Recording r = pushed();
  r.test_pulse[0] = r.test_pulse[9999] = 2.0;
  r.force_N(0, 0) = r.force_N(9999, 0) = -300.0;
  bridgeTestPulses(r);
  EXPECT_NEAR(r.force_N.minCoeff(), 20.0, 1e-9);
}

TEST(TestPulses, RecordingsThatDoNotTellStayAsTheyAre) {
  Recording r = pushed();
  r.test_pulse.resize(0);
  bridgeTestPulses(r);
  EXPECT_NEAR(r.force_N.maxCoeff(), 220.0, 1e-9);
  EXPECT_TRUE(r.notes.empty());
}

TEST(TestPulses, OneThatLastsAllTheRecordingIsLeftToTheFit) {
  Recording r = pushed();
  r.test_pulse.setOnes();
  bridgeTestPulses(r);
  EXPECT_NEAR(r.force_N.maxCoeff(), 220.0, 1e-9);
}

TEST(TestPulses, AreReadFromTheRecordersColumn) {
  const std::string header = "time_s,position_1_m,force_1_N,test_pulse\n";
  const Recording r = parseRecording(header + "0,0.5,1,0\n0.01,0.5,1,4\n0.02,0.5,1,0\n", "r.csv");
  ASSERT_EQ(r.test_pulse.size(), 3);
  EXPECT_EQ(r.test_pulse[1], 4.0);
}

}  // namespace
}  // namespace knee_robot::recording
