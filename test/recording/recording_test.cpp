#include "knee_robot/recording/recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knee_robot/base/errors.h"
#include "test/refusal.h"

namespace knee_robot::recording {
namespace {

const std::string kHeader =
    "time_s,reference_1_m,position_1_m,command_1_V,mocap_x_m,mocap_z_m,mocap_theta_rad,mocap_psi_rad\n";
const std::string kGood = kHeader +
                          "0.00,0.6,0.60,1.0,nan,nan,nan,nan\n"
                          "0.01,0.6,0.61,1.5,0.1,0.7,0.0,0.0\n"
                          "0.02,0.6,0.62,2.0,nan,0.7,NaN,0.0\n";

/// The message of the InputError that `content` causes; empty when it is accepted.
std::string refusal(const std::string& content) {
  return refusalOf([&] { parseRecording(content, "r.csv"); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

void expectRefused(const std::string& content, const std::string& part) {
  const std::string message = refusal(content);
  EXPECT_NE(message.find(part), std::string::npos) << "message: '" << message << "' lacks '" << part << "'";
}

TEST(Recording, ReadsColumnsByNameInAnyOrderAndIgnoresUnknownOnes) {
  const Recording r = parseRecording(
      "color,force_2_N,position_2_m,time_s,position_1_m,force_1_N\nred,2,0.2,5,0.1,1\nblue,4,0.4,6,0.3,3\n",
      "x/night_run.csv");
  EXPECT_EQ(r.name, "night_run");
  EXPECT_EQ(r.axes, 2);
  EXPECT_EQ(r.rows(), 2);
  EXPECT_DOUBLE_EQ(r.time_s[1], 6.0);
  EXPECT_DOUBLE_EQ(r.position_m(1, 0), 0.3);
  EXPECT_DOUBLE_EQ(r.position_m(1, 1), 0.4);
  EXPECT_DOUBLE_EQ(r.force_N(0, 1), 2.0);
  EXPECT_EQ(r.command_V.cols(), 0);
  EXPECT_EQ(r.mocap.cols(), 0);
  EXPECT_TRUE(r.notes.empty());
}

TEST(Recording, ReadsAChainsRadiansTorquesAndCurrents) {
  const Recording r = parseRecording(
      "time_s,position_1_rad,position_2_m,torque_1_Nm,force_2_N,current_1_A,current_2_A\n0,0.1,0.2,3,4,5,6\n", "r.csv");
  EXPECT_EQ(r.axes, 2);
  EXPECT_EQ(r.position_unit, (std::vector<std::string>{"rad", "m"}));
  EXPECT_EQ(r.force_unit, (std::vector<std::string>{"Nm", "N"}));
  EXPECT_EQ(r.force_N(0, 1), 4.0);
  EXPECT_EQ(r.current_A(0, 1), 6.0);
}

TEST(Recording, RefusesCurrentsWhereARobotNeedsForces) {
  const Recording r = parseRecording(replaced(kGood, "command_1_V", "current_1_A"), "r.csv");
  EXPECT_THROW(commandedForce(r, {56.8}), InputError);
}

TEST(Recording, NamesWhatAChainsJointLacks) {
  expectRefused("time_s,position_1_rad\n0,0.1\n", "torque_1_Nm is missing");
  expectRefused("time_s,position_1_rad,position_2_rad,torque_2_Nm\n0,0.1,0.2,1\n", "torque_1_Nm is missing");
  expectRefused("time_s,position_1_rad,position_2_rad,current_1_A\n0,0.1,0.2,1\n", "current_2_A is missing");
  expectRefused("time_s,position_1_rad,position_3_rad,current_1_A\n0,0.1,0.2,1\n", "position_2_m is missing");
}

TEST(Recording, AcceptsNanInCameraColumnsOnly) {
  const Recording r = parseRecording(kGood, "r.csv");
  EXPECT_TRUE(std::isnan(r.mocap(0, 0)));
  EXPECT_DOUBLE_EQ(r.mocap(1, 1), 0.7);
  expectRefused(replaced(kGood, "0.61,1.5", "nan,1.5"), "r.csv:3: position_1_m is 'nan'");
  expectRefused(replaced(kGood, "0.1,0.7", "inf,0.7"), "r.csv:3: mocap_x_m is 'inf'");
}

TEST(Recording, AcceptsCarriageReturnsBlanksByteOrderMarkAndEmptyLastLines) {
  std::string content = "\xEF\xBB\xBF" + kGood + "\n  \n";
  for (std::size_t at = 0; (at = content.find('\n', at)) != std::string::npos; at += 2)
    content.insert(at, "\r");
  content = replaced(content, ",0.61,", " ,\t0.61 ,");
  const Recording r = parseRecording(content, "r.csv");
  EXPECT_EQ(r.rows(), 3);
  EXPECT_DOUBLE_EQ(r.position_m(1, 0), 0.61);
}

TEST(Recording, LeavesOutALastLineThatACrashCutOffAndSaysSo) {
  for (const std::string& tail : {std::string("0.03,0.6,0.6"), std::string("0.03,0.6,0.63,2.0,nan,0.7,nan,-"),
                                  std::string("0.03,0.6,0.63,2.0,nan,0.7,nan,0"), std::string(40, '\0')}) {
    const Recording r = parseRecording(kGood + tail, "r.csv");
    EXPECT_EQ(r.rows(), 3) << tail;
    ASSERT_EQ(r.notes.size(), 1u) << tail;
    EXPECT_NE(r.notes[0].find("5"), std::string::npos);
  }
  const Recording whole = parseRecording(kGood + "0.03,0.6,0.63,2.0,nan,0.7,nan,0.1", "r.csv");
  EXPECT_EQ(whole.rows(), 4);
  EXPECT_TRUE(whole.notes.empty());
}

TEST(Recording, NamesTheMissingColumn) {
  expectRefused(replaced(kGood, "time_s", "time"), "r.csv:1: column time_s is missing");
  expectRefused(replaced(kGood, "position_1_m", "pos_1_m"), "column position_1_m is missing");
  expectRefused(replaced(kGood, "command_1_V", "voltage_1"), "column command_1_V is missing, and so is force_1_N");
  expectRefused(replaced(kGood, "mocap_psi_rad", "psi"), "column mocap_psi_rad is missing");
  expectRefused("time_s,position_1_m,position_3_m,command_1_V\n0,1,1,1\n", "column position_2_m is missing");
  expectRefused("time_s,position_1_m,position_2_m,command_1_V\n0,1,1,1\n", "column command_2_V is missing");
}

TEST(Recording, RefusesRowsThatDoNotFitNamingTheLine) {
  expectRefused("", "is empty");
  expectRefused(kHeader, "no complete row");
  expectRefused(replaced(kGood, "0.01,0.6,0.61", "0.01,0.61"), "r.csv:3: 7 values where the header has 8 columns");
  expectRefused(replaced(kGood, "0.01,0.6,0.61", "0.01,0.6,1,0.61"), "r.csv:3: 9 values");
  expectRefused(replaced(kGood, "0.61", "0,61"), "r.csv:3: 9 values");
  expectRefused(replaced(kGood, "0.61", "0x1p3"), "position_1_m is '0x1p3', not a finite number");
  expectRefused(replaced(kGood, "0.61", ""), "position_1_m is ''");
  expectRefused(replaced(kGood, "0.61", "1e7"), "beyond +-1e+06");
  expectRefused(replaced(kGood, "0.02,", "\n0.02,"), "r.csv:4: empty line");
  expectRefused(replaced(kGood, "position_1_m", "time_s"), "column time_s occurs twice");
}

TEST(Recording, RefusesTimeThatDoesNotIncrease) {
  expectRefused(replaced(kGood, "0.02,", "0.01,"), "r.csv:4: time_s is 0.01, not later than 0.01");
  expectRefused(replaced(kGood, "0.02,", "-3,"), "r.csv:4: time_s is -3");
}

TEST(Recording, ForceWinsOverCommandAndTheyMayDifferByOneDacStep) {
  const std::string header = "time_s,position_1_m,command_1_V,force_1_N\n";
  const Recording close = parseRecording(header + "0,0.6,1.0,56.9\n1,0.6,-1.0,-56.8\n", "r.csv");
  EXPECT_DOUBLE_EQ(commandedForce(close, {56.8})(0, 0), 56.9);
  EXPECT_THROW(commandedForce(close, {-56.8}), InputError);
  const Recording far = parseRecording(header + "0,0.6,1.0,56.8\n1,0.6,-1.0,-57.3\n", "r.csv");
  const std::string said = refusalOf([&] { commandedForce(far, {56.8}); });
  EXPECT_NE(said.find("r.csv:3: force_1_N -57.3 N and command_1_V -1 V"), std::string::npos) << said;
  const Recording volts = parseRecording("time_s,position_1_m,command_1_V\n0,0.6,2.0\n", "r.csv");
  EXPECT_DOUBLE_EQ(commandedForce(volts, {-56.8})(0, 0), -113.6);
}

TEST(Recording, RefusesAnotherNumberOfActuators) {
  const Recording r = parseRecording(kGood, "r.csv");
  EXPECT_NO_THROW(requireAxes(r, 1, "bench.yaml"));
  EXPECT_THROW(requireAxes(r, 4, "A.yaml"), InputError);
}

TEST(Recording, SurvivesArbitraryDamageWithAnInputErrorOrAValidRecording) {
  std::mt19937 random(7);
  const std::string alphabet = std::string("0123456789.,-+e\n\r\t naif_mVN\"\xff") + '\0';
  int accepted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string content = kGood;
    for (int change = 1 + static_cast<int>(random() % 4); change > 0; --change) {
      const std::size_t at = random() % content.size();
      const char c = alphabet[random() % alphabet.size()];
      switch (random() % 4) {
        case 0:
          content[at] = c;
          break;
        case 1:
          content.insert(at, 1, c);
          break;
        case 2:
          content.erase(at, 1 + random() % 5);
          break;
        default:
          content.resize(at + 1);
      }
      if (content.empty()) content = "x";
    }
    try {
      const Recording r = parseRecording(content, "r.csv");
      ++accepted;
      ASSERT_GE(r.rows(), 1);
      ASSERT_TRUE(r.position_m.allFinite());
      ASSERT_EQ(r.position_m.rows(), r.rows());
      ASSERT_TRUE(r.command_V.cols() > 0 || r.force_N.cols() > 0);
      for (int k = 1; k < r.rows(); ++k)
        ASSERT_GT(r.time_s[k], r.time_s[k - 1]);
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(accepted, 100) << "the damage should leave some recordings valid";
}

TEST(Recording, KnowsTheHomingItWasMadeAfter) {
  const std::string header = "time_s,position_1_m,force_1_N,home_id\n";
  EXPECT_EQ(parseRecording(header + "0,0.5,1,1763789012\n0.01,0.5,1,1763789012\n", "r.csv").home_id, 1763789012);
  EXPECT_EQ(parseRecording("time_s,position_1_m,force_1_N\n0,0.5,1\n", "r.csv").home_id, 0);
  const Recording homed_anew = parseRecording(header + "0,0.5,1,7\n0.01,0.5,1,8\n", "r.csv");
  EXPECT_EQ(homed_anew.home_id, 0);
  EXPECT_FALSE(homed_anew.notes.empty());
  EXPECT_THROW(parseRecording(header + "0,0.5,1,7.5\n", "r.csv"), InputError);
}

TEST(Recording, SaysWhatHidesColumnsThatTheUserSees) {
  const std::string rows = "0,0.1,1\n1,0.2,2\n", header = "time_s,position_1_m,force_1_N\n";
  const auto with = [](std::string text, char separator) {
    std::replace(text.begin(), text.end(), ',', separator);
    return text;
  };
  expectRefused(with(header + rows, ';'), "separated by ';'");
  expectRefused(with(header + rows, '\t'), "separated by tabs");
  expectRefused("\"time_s\",\"position_1_m\",\"force_1_N\"\n" + rows, "in quotes");
  expectRefused("TIME_S,POSITION_1_M,FORCE_1_N\n" + rows, "another case");
  expectRefused("# robot 2\n" + header + rows, "begins with a comment; remove what stands above line 2");
  expectRefused("Recorder v2\n2021\n" + header + rows, "above line 3");
  expectRefused(header + "s,m,N\n" + rows, "line of units");
  std::string cr = header + rows;
  std::replace(cr.begin(), cr.end(), '\n', '\r');
  expectRefused(cr, "end in CR alone");
  std::string wide = "\xFF\xFE";
  for (const char c : header + rows)
    wide += {c, '\0'};
  expectRefused(wide, "UTF-16");
  expectRefused("t,position_1_m\n" + rows, "column time_s is missing");
}

}  // namespace
}  // namespace knee_robot::recording
