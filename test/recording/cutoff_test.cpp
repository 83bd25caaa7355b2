#include "knee_robot/recording/cutoff.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

namespace knee_robot::recording {
namespace {

constexpr double kCutoffTestRate = 100.0;

/// Two actuators; position = reference + white noise of the given size (m).
UniformMotion noisy(const Eigen::MatrixXd& reference, double noise_m, unsigned seed) {
  UniformMotion motion{kCutoffTestRate, reference, reference, {}};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise_m);
  for (double& value : motion.position_m.reshaped())
    value += normal(random);
  return motion;
}

/// Sum of sines, `seconds` long, the given frequencies with equal acceleration.
Eigen::MatrixXd sines(double seconds, const std::vector<double>& frequencies) {
  Eigen::MatrixXd x(static_cast<int>(seconds * kCutoffTestRate), 2);
  for (Eigen::Index k = 0; k < x.rows(); ++k) {
    x.row(k).setZero();
    for (const double f : frequencies) {
      const double w = 2.0 * M_PI * f;
      x(k, 0) += 0.05 / (w * w) * std::sin(w * k / kCutoffTestRate + f);
      x(k, 1) += 0.05 / (w * w) * std::cos(w * k / kCutoffTestRate - f);
    }
  }
  return x;
}

/// Straight pieces between random points 0.5 s apart: white acceleration.
Eigen::MatrixXd straightPieces(double seconds, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 0.01);
  const int piece = 50;
  Eigen::MatrixXd x(static_cast<int>(seconds * kCutoffTestRate), 2);
  Eigen::RowVector2d from(0, 0), to(0, 0);
  for (Eigen::Index k = 0; k < x.rows(); ++k) {
    if (k % piece == 0) {
      from = to;
      to = {normal(random), normal(random)};
    }
    x.row(k) = from + (to - from) * static_cast<double>(k % piece) / piece;
  }
  return x;
}

/// What a robot with one time constant (s) makes of it.
Eigen::MatrixXd lagged(const Eigen::MatrixXd& x, double time_constant) {
  Eigen::MatrixXd y = x;
  const double step = 1.0 / kCutoffTestRate / time_constant;
  for (Eigen::Index k = 1; k < x.rows(); ++k)
    y.row(k) = y.row(k - 1) + step * (x.row(k) - y.row(k - 1));
  return y;
}

TEST(Cutoff, OfASmoothReferenceThatIsFollowedIsFiveTimesItsHighestFrequency) {
  const CutoffChoice choice = chooseCutoff({noisy(sines(60, {0.2, 0.4, 0.8}), 1e-7, 1)});
  EXPECT_NEAR(choice.drive_hz, 0.8, 0.41);  // two bins of 0.195 Hz
  EXPECT_EQ(choice.follow_hz, choice.drive_hz);
  EXPECT_NEAR(choice.cutoff_hz, 5.0 * choice.drive_hz, 1e-9);
}

TEST(Cutoff, DoesNotTakeTheRoundingOfTheReferenceForMotion) {
  Eigen::MatrixXd reference = sines(60, {0.2, 0.5});
  const CutoffChoice exact = chooseCutoff({noisy(reference, 1e-7, 1)});
  for (double& value : reference.reshaped())
    value = 1e-6 * std::round(1e6 * value);
  // Rounding's acceleration power is far above the motion's here, almost all of it near the Nyquist frequency.
  const CutoffChoice rounded = chooseCutoff({noisy(reference, 1e-7, 1)});
  EXPECT_NEAR(rounded.cutoff_hz, exact.cutoff_hz, 1.0);
}

TEST(Cutoff, OfAReferenceWithStepsOfVelocityEndsWhereTheRecordingNoLongerFollows) {
  UniformMotion motion = noisy(straightPieces(90, 3), 0.0, 1);
  motion.position_m = lagged(motion.reference_m, 0.05);
  motion.position_m = noisy(motion.position_m, 30e-6, 2).position_m;
  const CutoffChoice quiet = chooseCutoff({motion});
  motion.position_m = noisy(lagged(motion.reference_m, 0.05), 120e-6, 2).position_m;
  const CutoffChoice loud = chooseCutoff({motion});
  EXPECT_GT(quiet.drive_hz, 8.0) << "white acceleration";
  EXPECT_LT(loud.follow_hz, quiet.follow_hz);
  EXPECT_LT(loud.follow_hz, loud.drive_hz);
  EXPECT_NEAR(loud.cutoff_hz, 1.5 * loud.follow_hz, 1e-9);
  // At the end of the followed band asked and unasked acceleration are alike: s_rr |H|^2 = noise (2 pi f)^4 / rate * 2.
  const double f = loud.follow_hz, w = 2.0 * M_PI * f;
  double power = 0.0;
  for (std::size_t k = 0; k < loud.frequency_hz.size(); ++k) {
    if (std::abs(loud.frequency_hz[k] - f) < 0.5) power = std::max(power, loud.reference_power[k]);
  }
  const double asked = power / (1.0 + std::pow(0.05 * w, 2));
  const double unasked = std::pow(120e-6, 2) * 2.0 / kCutoffTestRate * std::pow(w, 4);
  EXPECT_LT(asked / unasked, 8.0);
  EXPECT_GT(asked / unasked, 1.0 / 8.0);
}

TEST(Cutoff, StaysWithinItsBounds) {
  EXPECT_DOUBLE_EQ(chooseCutoff({noisy(sines(100, {0.02}), 1e-7, 1)}).cutoff_hz, 1.0);
  EXPECT_DOUBLE_EQ(chooseCutoff({noisy(sines(60, {1.0, 4.0}), 1e-9, 1)}).cutoff_hz, 10.0);
}

TEST(Cutoff, SaysSoWhenThereIsNoReferenceOrNoMotion) {
  Recording recording;
  recording.time_s = {0.0, 0.01, 0.02};
  recording.position_m = Eigen::MatrixXd::Zero(3, 1);
  for (const CutoffChoice& choice :
       {chooseCutoff({&recording}), chooseCutoff({noisy(Eigen::MatrixXd::Ones(1000, 2), 1e-6, 1)})}) {
    EXPECT_DOUBLE_EQ(choice.cutoff_hz, 3.0);
    EXPECT_NE(choice.sentence.find("no reference"), std::string::npos) << choice.sentence;
  }
}

TEST(Cutoff, IsTheSameForAFasterRecordingOfTheSameMotion) {
  Recording slow, fast;
  for (Recording* r : {&slow, &fast}) {
    const int per_second = r == &slow ? 100 : 1000;
    r->reference_m.resize(60 * per_second, 1);
    for (int k = 0; k < 60 * per_second; ++k) {
      r->time_s.push_back(static_cast<double>(k) / per_second);
      const double t = r->time_s.back();
      r->reference_m(k, 0) = 0.02 * std::sin(2.0 * t) + 0.005 * std::sin(5.0 * t);
    }
    r->position_m = r->reference_m;
  }
  EXPECT_NEAR(chooseCutoff({&slow}).cutoff_hz, chooseCutoff({&fast}).cutoff_hz, 1.0);
}

Recording sampled(double rate_hz, bool with_reference, const std::vector<double>& frequencies) {
  Recording r;
  const int rows = static_cast<int>(40 * rate_hz);
  r.position_m.resize(rows, 1);
  for (int k = 0; k < rows; ++k) {
    r.time_s.push_back(k / rate_hz);
    double x = 0.0;
    for (const double f : frequencies)
      x += 0.05 / f * std::sin(2.0 * M_PI * f * r.time_s.back() + f);
    r.position_m(k, 0) = 1e-6 * std::round(1e6 * x);
  }
  if (with_reference) r.reference_m = r.position_m;
  return r;
}

TEST(Cutoff, OfAFastRecordingHasNoUpperEndOf10Hz) {
  for (const bool with_reference : {true, false}) {
    const Recording r = sampled(1000.0, with_reference, {0.5, 4.0, 8.0});
    const CutoffChoice choice = chooseCutoff({&r});
    EXPECT_NEAR(choice.cutoff_hz, 40.0, 3.0) << choice.sentence;
  }
}

/// Without the rows of pauses of 3 to 18 ms, one and a half a second: a machine that does other things, too.
Recording withGaps(const Recording& all) {
  std::mt19937 random(3);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < all.rows(); ++k) {
    kept.push_back(k);
    if (random() % 700 == 0) k += 2 + static_cast<Eigen::Index>(random() % 15);
  }
  Recording r;
  for (const Eigen::Index k : kept)
    r.time_s.push_back(all.time_s[static_cast<std::size_t>(k)]);
  r.position_m = all.position_m(kept, Eigen::all);
  r.reference_m = all.reference_m(kept, Eigen::all);
  return r;
}

TEST(Cutoff, OfARecordingThatSkippedRowsIsThatOfTheMotion) {
  const Recording whole = sampled(1000.0, true, {0.2, 0.5, 0.8}), skipped = withGaps(whole);
  ASSERT_LT(skipped.rows(), whole.rows() - 100);
  EXPECT_NEAR(chooseCutoff({&skipped}).cutoff_hz, chooseCutoff({&whole}).cutoff_hz, 0.2)
      << chooseCutoff({&skipped}).sentence;
}

TEST(Cutoff, OfAMotionThatStoodStillWithTheControllerIsThatOfTheRest) {
  Recording r = sampled(1000.0, true, {0.2, 0.5, 0.8});
  const double planned_hz = chooseCutoff({&r}).cutoff_hz;
  for (const int row : {9000, 9400, 31000})  // nothing moved for 40 ms, and no row was written
    for (std::size_t k = static_cast<std::size_t>(row); k < r.time_s.size(); ++k)
      r.time_s[k] += 0.04;
  const CutoffChoice found = chooseCutoff({&r});
  EXPECT_NEAR(found.cutoff_hz, planned_hz, 0.2) << found.sentence;
}

TEST(Cutoff, OfARecordingThatIsMostlyGapsIsChosenWithoutFillingThem) {
  Recording r = sampled(1000.0, true, {0.2, 0.5, 0.8});
  for (std::size_t k = 0; k < r.time_s.size(); ++k)
    r.time_s[k] += 50.0 * static_cast<double>(k / 1000);
  EXPECT_GT(chooseCutoff({&r}).cutoff_hz, 0.0);
}

TEST(Cutoff, OfAHeldReferenceIsNotThatOfItsSteps) {
  Recording r = sampled(1000.0, true, {0.3, 0.6});
  for (int k = 0; k < r.rows(); ++k)
    r.reference_m(k, 0) = r.position_m(k - k % 10, 0);
  EXPECT_LT(chooseCutoff({&r}).cutoff_hz, 5.0);
}

TEST(Cutoff, OfARecordingWithMinutesBetweenItsRowsIsChosenToo) {  // milliseconds in a column of seconds
  UniformMotion slow;
  slow.rate_hz = 0.05;
  slow.position_m.resize(1000, 1);
  for (Eigen::Index k = 0; k < 1000; ++k)
    slow.position_m(k, 0) = std::sin(0.05 * static_cast<double>(k));
  EXPECT_GT(chooseCutoff({slow}).cutoff_hz, 0.0);
}

TEST(Cutoff, WithoutReferenceFollowsTheRecordedVelocity) {
  const Recording slow = sampled(100.0, false, {0.2, 0.4});
  EXPECT_NEAR(chooseCutoff({&slow}).cutoff_hz, 2.0, 1.0);
}

TEST(Cutoff, OfTheMeasuredRecordingsIsNearWhatAnIndependentAnalysisChose) {
  const char* shared = std::getenv("KNEE_SHARED_DIR");
  const std::filesystem::path folder =
      std::filesystem::path(shared ? shared : KNEE_SOURCE_DIR "/../shared") / "data" / "measured";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no measured recordings at " << folder;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    const Recording recording = loadRecording(file.string());
    const CutoffChoice choice = chooseCutoff({&recording});
    std::printf("%-28s %s\n", recording.name.c_str(), choice.sentence.c_str());
    EXPECT_GE(choice.cutoff_hz, 1.0);
    EXPECT_LE(choice.cutoff_hz, 10.0);
    if (recording.name[0] == 'B' && recording.name[1] == '_') {
      EXPECT_GT(choice.cutoff_hz, 2.0);  // 3 Hz there
      EXPECT_LT(choice.cutoff_hz, 5.0);
    }
  }
}

}  // namespace
}  // namespace knee_robot::recording
