#include "src/recording/reference_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/recording/cutoff.h"

namespace knee_robot::recording {
namespace {

/// Two axes that follow their references with a lag of 30 ms.
Recording followed() {
  Recording r;
  r.path = "followed.csv";
  r.axes = 2;
  r.position_m.resize(3000, 2);
  r.reference_m.resize(3000, 2);
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.01 * k;
    r.time_s.push_back(t);
    const auto at = [](double s) {
      return Eigen::RowVector2d(0.6 + 0.05 * std::sin(1.9 * s) + 0.01 * std::sin(6.0 * s),
                                0.8 + 0.06 * std::sin(1.9 * s + 0.4) + 0.01 * std::cos(5.0 * s));
    };
    r.reference_m.row(k) = at(t);
    r.position_m.row(k) = at(t - 0.03);
  }
  return r;
}

TEST(WhyNotFollowed, SaysNothingOfAReferenceThatIsFollowedOrNotThere) {
  Recording r = followed();
  EXPECT_EQ(whyNotFollowed(r), "");
  r.position_m.array() += 0.02;  // homed 20 mm off
  EXPECT_EQ(whyNotFollowed(r), "");
  r.reference_m.resize(3000, 0);
  EXPECT_EQ(whyNotFollowed(r), "");
}

TEST(WhyNotFollowed, SaysNothingOfAnAxisThatHoldsItsReference) {
  Recording r = followed();
  r.reference_m.col(1).setConstant(0.8);
  for (int k = 0; k < r.rows(); ++k)
    r.position_m(k, 1) = 0.8 + 1e-3 * std::sin(0.05 * k);  // and yields a little
  EXPECT_EQ(whyNotFollowed(r), "");
}

TEST(WhyNotFollowed, NamesWhatIsWrongWithIt) {
  const auto expect = [](const Recording& r, const std::string& words) {
    EXPECT_NE(whyNotFollowed(r).find(words), std::string::npos) << whyNotFollowed(r);
  };
  Recording r = followed();
  r.reference_m.col(1).setConstant(0.8);
  expect(r, "reference 2 stands while the axis moves");
  r = followed();
  r.reference_m *= 1000.0;
  expect(r, "reference 1 moves 1e+03 times as far as the axis");
  r = followed();
  r.reference_m.col(0).swap(r.reference_m.col(1));
  expect(r, "reference 1 is what axis 2 does");
  r = followed();
  r.reference_m.col(1).array() += 0.4;
  expect(r, "reference 2 lies");
  r = followed();
  r.reference_m.col(0).reverseInPlace();
  expect(r, "reference 1 moves otherwise than the axis");
}

TEST(Cutoff, AReferenceThatIsNotFollowedDecidesNothing) {
  Recording r = followed();
  r.reference_m *= 1000.0;
  Recording without = r;
  without.reference_m.resize(3000, 0);
  const CutoffChoice choice = chooseCutoff({&r}), plain = chooseCutoff({&without});
  EXPECT_EQ(choice.cutoff_hz, plain.cutoff_hz);
  EXPECT_EQ(choice.sentence.find(plain.sentence), 0u) << choice.sentence;
  EXPECT_NE(choice.sentence.find("followed.csv: reference 1 moves 1e+03 times"), std::string::npos) << choice.sentence;
}

TEST(Cutoff, AJumpOfThePositionDecidesNothing) {
  Recording r = followed();
  r.reference_m.resize(3000, 0);
  CutoffRule rule;
  rule.fastest_m_per_s = {0.5, 0.5};
  const double whole_hz = chooseCutoff({&r}, rule).cutoff_hz;
  r.position_m.col(0).tail(1500).array() += 0.05;
  EXPECT_GT(chooseCutoff({&r}).cutoff_hz, 1.5 * whole_hz) << "it would decide";
  EXPECT_NEAR(chooseCutoff({&r}, rule).cutoff_hz, whole_hz, 1e-9);
}

}  // namespace
}  // namespace knee_robot::recording
