#include "src/identification/places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace knee_robot::identification {
namespace {

/// Two axes along sums of sines whose frequencies have no common period (repeat_s = 0) or that start anew every
/// repeat_s; a little noise.
Eigen::MatrixXd motion(int samples, double repeat_s, double noise) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, noise);
  Eigen::MatrixXd state(samples, 4);
  for (int n = 0; n < samples; ++n) {
    const double t = repeat_s > 0.0 ? std::fmod(0.033 * n, repeat_s) : 0.033 * n;
    for (int i = 0; i < 2; ++i) {
      const double w = i == 0 ? 1.0 : std::sqrt(3.0), u = i == 0 ? std::sqrt(7.0) : std::sqrt(11.0);
      state(n, i) = std::sin(w * t + i) + 0.4 * std::cos(u * t) + normal(random);
      state(n, 2 + i) = w * std::cos(w * t + i) - 0.4 * u * std::sin(u * t) + normal(random);
    }
  }
  return state;
}

/// Stretches of 40 samples.
std::vector<int> runs(int samples) {
  std::vector<int> run;
  for (int n = 0; n < samples; ++n)
    run.push_back(n / 40);
  return run;
}

int onTheirOwn(const std::vector<int>& first) {
  int count = 0;
  for (std::size_t k = 0; k < first.size(); ++k)
    count += first[k] == static_cast<int>(k);
  return count;
}

TEST(FirstVisits, SendARepeatedMotionBackToItsFirstTime) {
  const int once = 600;  // 19.8 s
  const std::vector<int> first = firstVisits(motion(10 * once, 0.033 * once, 0.005), runs(10 * once));
  int later = 0, found = 0, near = 0;
  for (int k = once; k < 10 * once; ++k) {
    const int place = first[static_cast<std::size_t>(k)];
    ++later;
    found += place < once;
    near += std::abs(k % once - place) < 60 || std::abs(k % once - place) > once - 60;
  }
  EXPECT_GT(found, 0.99 * later);
  EXPECT_GT(near, 0.9 * later) << "two axes cross their own path here and there";
  for (const int place : first)
    EXPECT_EQ(first[static_cast<std::size_t>(place)], place);
}

TEST(FirstVisits, LeaveMotionThatIsNewOnItsOwn) {
  const int samples = 1200;
  EXPECT_GT(onTheirOwn(firstVisits(motion(samples, 0.0, 0.0), runs(samples))), 0.6 * samples);
}

TEST(FirstVisits, TakeAnAxisAtRestForNoReasonToDoubt) {
  Eigen::MatrixXd state = motion(3000, 9.9, 0.001);
  state.col(1) = Eigen::VectorXd::Random(3000) * 1e-7;  // rests: its noise is not its motion
  state.col(3) = Eigen::VectorXd::Random(3000) * 1e-7;
  EXPECT_LT(onTheirOwn(firstVisits(state, runs(3000))), 400);
}

}  // namespace
}  // namespace knee_robot::identification
