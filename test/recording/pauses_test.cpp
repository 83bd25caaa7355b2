#include "knee_robot/recording/pauses.h"

#include <gtest/gtest.h>

namespace knee_robot::recording {
namespace {

TEST(Pauses, AreClosedToTheLongestThatIsAllowedAndNoted) {
  Recording r;
  r.time_s = {10.0, 10.01, 10.02, 110.02, 110.03, 111.5};
  EXPECT_NEAR(closePauses(r, 2.0), 98.0, 1e-9);
  const double expected[] = {10.0, 10.01, 10.02, 12.02, 12.03, 13.5};
  for (std::size_t k = 0; k < r.time_s.size(); ++k)
    EXPECT_NEAR(r.time_s[k], expected[k], 1e-9);
  ASSERT_EQ(r.notes.size(), 1u);
  EXPECT_NE(r.notes[0].find("98 s were closed"), std::string::npos) << r.notes[0];
}

TEST(Pauses, LeaveARecordingWithoutThemAsItIs) {
  Recording r;
  r.time_s = {0.0, 0.01, 1.5, 1.51};
  const std::vector<double> before = r.time_s;
  EXPECT_EQ(closePauses(r, 2.0), 0.0);
  EXPECT_EQ(r.time_s, before);
  EXPECT_TRUE(r.notes.empty());
}

}  // namespace
}  // namespace knee_robot::recording
