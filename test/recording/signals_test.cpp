#include "knee_robot/recording/signals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/recording/cutoff.h"

namespace knee_robot::recording {
namespace {

double path(double t) {
  return 0.7 + 0.05 * std::sin(2 * M_PI * 0.5 * t);
}
double speed(double t) {
  return 0.05 * M_PI * std::cos(M_PI * t);
}
double acceleration(double t) {
  return -0.05 * M_PI * M_PI * std::sin(M_PI * t);
}

/// One axis along `path`, with the given row times; the force of row k is held to row k + 1.
Recording along(const std::vector<double>& time) {
  Recording r;
  r.path = "r.csv";
  r.axes = 1;
  r.time_s = time;
  r.position_m.resize(r.rows(), 1);
  r.force_N.resize(r.rows(), 1);
  for (int k = 0; k < r.rows(); ++k) {
    r.position_m(k, 0) = path(time[k]);
    r.force_N(k, 0) = time[k];
  }
  return r;
}

std::vector<double> jitteredTimes(int n, double period, double jitter, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  std::vector<double> t;
  for (int k = 0; k < n; ++k)
    t.push_back(100.0 + k * period + uniform(random));
  return t;
}

TEST(HeldMeans, AverageTheValueThatWasInForce) {
  const std::vector<double> t = {0.0, 1.0, 3.0};
  Eigen::MatrixXd v(3, 1);
  v << 10, 20, 40;
  const Eigen::MatrixXd m = heldMeans(t, v, {0.5, 1.0, 2.5, 3.0, 9.0, -5.0}, 1.0);
  EXPECT_DOUBLE_EQ(m(0, 0), 10);  // wholly in the first
  EXPECT_DOUBLE_EQ(m(1, 0), 15);  // half and half
  EXPECT_DOUBLE_EQ(m(2, 0), 20);  // 2 .. 3: still the second
  EXPECT_DOUBLE_EQ(m(3, 0), 30);  // 2.5 .. 3.5
  EXPECT_DOUBLE_EQ(m(4, 0), 40);  // the last one goes on
  EXPECT_DOUBLE_EQ(m(5, 0), 10);  // the first one began before
}

TEST(Resample, ACommandActsAfterItsRowSoARampIsDelayedByHalfAPeriod) {
  const Recording r = along(jitteredTimes(500, 0.01, 0.0, 1));
  const Signals s = resample(r, r.force_N);
  for (int n = 5; n < s.samples() - 5; ++n)
    EXPECT_NEAR(s.force_N(n, 0), s.time_s[n] - 0.005, 1e-9);
}

TEST(Resample, GivesMotionThroughJitterAndQuantizationFreeRows) {
  SignalOptions options;
  options.motion_cutoff_hz = 15.0;
  const Recording r = along(jitteredTimes(2000, 0.01, 0.002, 2));
  const Signals s = resample(r, r.force_N, options);
  EXPECT_NEAR(s.period_s, 0.01, 1e-4);
  for (int n = 50; n < s.samples() - 50; ++n) {
    const double t = s.time_s[n];
    EXPECT_NEAR(s.position_m(n, 0), path(t), 1e-6);
    EXPECT_NEAR(s.velocity_m_per_s(n, 0), speed(t), 1e-4);
    EXPECT_NEAR(s.acceleration_m_per_s2(n, 0), acceleration(t), 5e-3);
  }
}

TEST(Resample, ThinsFastRecordingsAfterFiltering) {
  Recording r = along(jitteredTimes(20000, 0.001, 0.0, 3));
  std::mt19937 random(5);
  for (int k = 0; k < r.rows(); ++k)
    r.position_m(k, 0) = std::round(r.position_m(k, 0) / 5e-6) * 5e-6;
  const Signals s = resample(r, r.force_N);
  EXPECT_NEAR(s.period_s, 0.01, 1e-6);
  EXPECT_NEAR(s.samples(), 2000, 2);
  for (int n = 50; n < s.samples() - 50; ++n) {
    EXPECT_NEAR(s.velocity_m_per_s(n, 0), speed(s.time_s[n]), 2e-4);
    EXPECT_NEAR(s.acceleration_m_per_s2(n, 0), acceleration(s.time_s[n]), 2e-2);
    EXPECT_NEAR(s.force_N(n, 0), s.time_s[n] - 0.0005, 1e-6);
  }
}

TEST(Resample, KeepsFastMotionsOnThePathOfFrictionWhereThatIsLowPassedWider) {
  std::vector<double> time(4000);
  for (std::size_t k = 0; k < time.size(); ++k)
    time[k] = 1e-3 * static_cast<double>(k);
  Recording r = along(time);
  const auto fast = [](double t) { return 5e-5 * std::sin(2.0 * M_PI * 20.0 * t); };
  for (int k = 0; k < r.rows(); ++k)
    r.position_m(k, 0) += fast(time[static_cast<std::size_t>(k)]);
  SignalOptions options;
  options.motion_cutoff_hz = 5.0;
  EXPECT_EQ(resample(r, r.force_N, options).path_m.cols(), 0) << "one path for both";
  options.path_cutoff_hz = 80.0;
  options.rate_hz = 250.0;
  const Signals s = resample(r, r.force_N, options);
  ASSERT_EQ(s.path_m.rows(), s.samples());
  for (int n = 50; n + 50 < s.samples(); ++n) {
    const double t = s.time_s[static_cast<std::size_t>(n)];
    EXPECT_NEAR(s.position_m(n, 0), path(t), 5e-6) << "the motion";
    EXPECT_NEAR(s.path_m(n, 0), path(t) + fast(t), 2e-6) << "the path";
  }
  EXPECT_LT(s.tremble_m_per_s.mean(), 2e-4) << "what is on the path is no tremble: 4 mm/s of it";
}

TEST(Resample, MarksGapsAsUnknownAndSaysSo) {
  std::vector<double> t = jitteredTimes(1000, 0.01, 0.0005, 4);
  t.erase(t.begin() + 400, t.begin() + 450);  // half a second
  const Recording r = along(t);
  const Signals s = resample(r, r.force_N);
  int unknown = 0;
  for (const char known : s.known)
    unknown += !known;
  EXPECT_NEAR(unknown, 50, 3);
  EXPECT_NE(s.notes.back().find("gaps"), std::string::npos);
}

TEST(Resample, GoesThroughTheCyclesThatABusyMachineSkips) {
  std::mt19937 random(6);
  std::uniform_int_distribution<std::size_t> skipped(4, 15), on_time(30, 150);
  const std::vector<double> all = jitteredTimes(20000, 0.001, 0.0, 3);
  std::vector<double> t;
  for (std::size_t k = 0; k < all.size(); k += skipped(random))
    for (const std::size_t end = std::min(all.size(), k + on_time(random)); k < end; ++k)
      t.push_back(all[k]);
  Recording r = along(t);
  for (int k = 0; k < r.rows(); ++k)
    r.position_m(k, 0) = std::round(r.position_m(k, 0) / 5e-6) * 5e-6;
  const Signals s = resample(r, r.force_N);
  for (int n = 50; n < s.samples() - 50; ++n) {
    EXPECT_TRUE(s.known[n]);
    EXPECT_NEAR(s.velocity_m_per_s(n, 0), speed(s.time_s[n]), 2e-4);
    EXPECT_NEAR(s.acceleration_m_per_s2(n, 0), acceleration(s.time_s[n]), 2e-2);
  }
}

TEST(Resample, DropsStaleRowsAtTheStart) {
  Recording r = along(jitteredTimes(500, 0.01, 0.0, 4));
  for (int k = 0; k < 3; ++k)
    r.position_m(k, 0) = 0.1;  // left over from the run before
  const Signals s = resample(r, r.force_N);
  EXPECT_NEAR(s.time_s.front(), r.time_s[3], 1e-12);
  EXPECT_NEAR(s.position_m(0, 0), path(r.time_s[3]), 1e-4);
  EXPECT_NE(s.notes.back().find("3 row(s) are stale"), std::string::npos);
}

TEST(Resample, RefusesWhatIsTooShort) {
  const Recording r = along(jitteredTimes(10, 0.01, 0.0, 1));
  EXPECT_THROW(resample(r, r.force_N), Refusal);
}

TEST(Resample, TellsStampsInBurstsFromLongGaps) {
  const auto refusal = [](const std::vector<double>& times) -> std::string {
    const Recording r = along(times);
    try {
      resample(r, r.force_N);
    } catch (const Refusal& refused) {
      return refused.what();
    }
    return "";
  };
  std::vector<double> bursts, gaps;
  for (int k = 0; k < 900; ++k) {
    bursts.push_back(0.01 * (k / 3) + 1e-9 * (k % 3));
    gaps.push_back(1e-3 * k + 1000.0 * (k / 300));
  }
  EXPECT_NE(refusal(bursts).find("stamps come in bursts"), std::string::npos) << refusal(bursts);
  EXPECT_NE(refusal(gaps).find("cut the recording at its long gaps"), std::string::npos) << refusal(gaps);
  for (int k = 450; k < 900; ++k)
    gaps[static_cast<std::size_t>(k)] += 1e9;  // somebody has set the clock
  EXPECT_NE(refusal(gaps).find("cut the recording at its long gaps"), std::string::npos) << refusal(gaps);
  const Recording r = along(gaps);
  EXPECT_EQ(chooseCutoff({&r}).follow_hz, CutoffChoice().follow_hz)
      << "once it filled the memory with the years between";
}

TEST(AtHoldIntervals, LooksInTheMiddleOfTheIntervalInWhichTheRowsForceHolds) {
  const Recording r = along(jitteredTimes(300, 0.01, 0.002, 6));
  const Signals s = resample(r, r.force_N);
  Eigen::MatrixXd time(s.samples(), 1);
  for (int n = 0; n < s.samples(); ++n)
    time(n, 0) = s.time_s[n];
  const Eigen::MatrixXd rows = atHoldIntervals(s, time, r.time_s);
  ASSERT_EQ(rows.rows(), r.rows());
  for (int k = 1; k + 3 < r.rows(); ++k)
    EXPECT_NEAR(rows(k, 0), (r.time_s[k] + r.time_s[k + 1]) / 2, 1e-9);
  EXPECT_TRUE(rows.allFinite());
}

TEST(Signals, SayThatAPositionWhichNeverLeavesItsReferenceWasHardlyMeasured) {
  Recording r = along(jitteredTimes(400, 0.01, 0.0, 1));
  const auto said = [&] {
    for (const std::string& note : resample(r, r.force_N).notes) {
      if (note.find("same in every row of actuator 1") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_FALSE(said()) << "it has no reference";
  r.reference_m = r.position_m;
  EXPECT_TRUE(said());
  r.reference_m(200, 0) += 2e-5;
  EXPECT_FALSE(said());
  r.position_m.setConstant(0.7);
  r.reference_m = r.position_m;
  EXPECT_FALSE(said()) << "it rests";
}

}  // namespace
}  // namespace knee_robot::recording
