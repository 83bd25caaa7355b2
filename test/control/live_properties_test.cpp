#include "src/control/live_properties.h"

#include <gtest/gtest.h>

namespace knee_robot::control {
namespace {

rt::PropertyReport was(const std::string& value, const std::string& unit) {
  rt::PropertyReport report;
  report.component = "Driver1";
  report.name = "proportional_N_per_m";
  report.value = value;
  report.unit = unit;
  return report;
}

TEST(ChangesWithAPatient, StayWithinAFifthOfWhatWasBothWays) {
  EXPECT_EQ(whyTooFar(was("60000", "N/m"), "71999"), "");
  EXPECT_EQ(whyTooFar(was("60000", "N/m"), "48001"), "");
  EXPECT_NE(whyTooFar(was("60000", "N/m"), "72001"), "");
  EXPECT_NE(whyTooFar(was("60000", "N/m"), "47999"), "");
}

TEST(ChangesWithAPatient, OfAPayloadStayWithinTwoKilograms) {
  EXPECT_EQ(whyTooFar(was("0", "kg"), "1.9"), "");
  EXPECT_NE(whyTooFar(was("10", "kg"), "12.1"), "");
}

TEST(ChangesWithAPatient, SayWhatWasAndHowFarItMayGo) {
  const std::string why = whyTooFar(was("60000", "N/m"), "90000");
  EXPECT_NE(why.find("Driver1.proportional_N_per_m was 60000"), std::string::npos) << why;
  EXPECT_NE(why.find("12000 N/m"), std::string::npos) << why;
}

TEST(ChangesWithAPatient, AreRefusedWhereTheNewValueIsNoNumber) {
  EXPECT_NE(whyTooFar(was("60000", "N/m"), "nan"), "");
  EXPECT_NE(whyTooFar(was("60000", "N/m"), "inf"), "");
}

}  // namespace
}  // namespace knee_robot::control
