#include "knee_robot/trajectory/reference_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "knee_robot/base/errors.h"
#include "test/refusal.h"

namespace knee_robot::trajectory {
namespace {

/// The message of the InputError that parsing `text` throws; empty when it throws none.
std::string refusal(const std::string& text, std::optional<Space> space = std::nullopt) {
  return refusalOf([&] { parseReference(text, "file.txt", space); });
}

TEST(ReferenceFile, ReadsPlainPointsAsActuatorLengthsTenMillisecondsApart) {
  const Reference reference = parseReference("0.1 0.2 0.3 0.4\n0.5 0.6 0.7 0.8\n", "file.txt");
  ASSERT_EQ(reference.points.rows(), 2);
  EXPECT_EQ(reference.space, Space::Actuator);
  EXPECT_EQ(reference.period_s, 0.01);
  EXPECT_EQ(reference.points(1, 2), 0.7);
  EXPECT_EQ(reference.lineOf(1), 2);
}

TEST(ReferenceFile, AcceptsCarriageReturnsTabsTrailingBlanksEmptyLastLinesAndAMissingLastNewline) {
  const std::string text = "0.1\t0.2 0.3  0.4 \t\r\n -0.5 +0.6 7e-1 0.8\r\n";
  for (const std::string& end : {std::string(), std::string("\r\n \t\n"), std::string("1 2 3 4")}) {
    const Reference reference = parseReference(text + end, "file.txt");
    EXPECT_EQ(reference.points.rows(), end == "1 2 3 4" ? 3 : 2);
    EXPECT_EQ(reference.points(0, 3), 0.4);
    EXPECT_EQ(reference.points(1, 0), -0.5);
  }
}

TEST(ReferenceFile, TakesSpaceAndPeriodFromItsHeaderAndCountsItsLines) {
  const Reference reference =
      parseReference("# a remark\n#space:  platform\r\n# Period_s: 0.02\n\n1 2 3 4\n5 6 7 8", "f");
  EXPECT_EQ(reference.space, Space::Platform);
  EXPECT_EQ(reference.period_s, 0.02);
  EXPECT_EQ(reference.lineOf(0), 5);
  EXPECT_EQ(reference.lineOf(1), 6);
}

TEST(ReferenceFile, TakesTheCallersSpaceUnlessTheHeaderContradictsIt) {
  EXPECT_EQ(parseReference("1 2 3 4", "f", Space::Relative).space, Space::Relative);
  EXPECT_EQ(parseReference("# space: relative\n1 2 3 4", "f", Space::Relative).space, Space::Relative);
  EXPECT_EQ(
      refusal("# x\n# space: relative\n1 2 3 4", Space::Platform),
      "file.txt:2: the header says space: relative, but platform was asked for; drop --space or correct the header");
}

TEST(ReferenceFile, RefusesEverythingElseByFileAndLine) {
  const std::string good = "1 2 3 4\n";
  const std::pair<std::string, std::string> cases[] = {
      {good + "1 2 3 4 5\n", "file.txt:2: has a fifth column '5'"},
      {good + good + "1 2 3\n", "file.txt:3: has 3 of the four numbers"},
      {good + "1 2 x 4\n", "file.txt:2: column 3 'x' is no finite number"},
      {"1 2 nan 4\n", "file.txt:1: column 3 'nan' is no finite number"},
      {good + "1 inf 3 4\n", "file.txt:2: column 2 'inf' is no finite number"},
      {good + "1 -Infinity 3 4\n", "column 2 '-Infinity'"},
      {good + "1 2 3 1e999\n", "file.txt:2: column 4 '1e999' is no finite number"},
      {good + "1 2 3 0x10\n", "column 4 '0x10'"},
      {good + "1,2,3,4\n", "column 1 '1,2,3,4'"},
      {good + "1 2 3 4;\n", "column 4 '4;'"},
      {good + std::string("1 2 3 4\0\n", 9), "column 4 '4?'"},
      {good + "\n" + good, "file.txt:2: an empty line stands between points"},
      {good + "# note\n" + good, "file.txt:2: a comment stands after the first point"},
      {"", "file.txt:1: holds no point"},
      {"\n \r\n", "holds no point"},
      {"# space: actuator\n", "file.txt:1: holds no point"},
      {"# space: joint\n" + good, "file.txt:1: space 'joint' is unknown"},
      {"# space: actuator\n# space: actuator\n" + good, "file.txt:2: space is declared twice"},
      {"# period_s: nan\n" + good, "file.txt:1: period_s 'nan'"},
      {"# period_s: 0\n" + good, "file.txt:1: period_s '0'"},
  };
  for (const auto& [text, expected] : cases) {
    EXPECT_NE(refusal(text).find(expected), std::string::npos)
        << "expected: " << expected << "\n     got: " << refusal(text);
  }
}

TEST(ReferenceFile, RefusesMoreThanItsLimits) {
  std::string text;
  for (Eigen::Index k = 0; k <= kMaxReferencePoints; ++k)
    text += "0 0 0 0\n";
  EXPECT_EQ(refusal(text), "file.txt:1000001: is beyond the limit of 1000000 points; split the file");
  EXPECT_NE(refusal(std::string(kMaxReferenceBytes + 1, '\n')).find("more than the limit of 67108864"),
            std::string::npos);
  EXPECT_THROW(readReference("/nonexistent/file.txt"), InputError);
  EXPECT_THROW(readReference("/"), InputError);
}

TEST(ReferenceFile, ReadsBackWhatItWrites) {
  Reference reference;
  reference.space = Space::Platform;
  reference.points = Points::Random(50, 4);
  const std::string path = testing::TempDir() + "knee_reference_file_" + std::to_string(::getpid()) + ".txt";
  writeReference(path, reference, {"planned by a test", "second remark"});
  const Reference again = readReference(path);
  std::filesystem::remove(path);
  EXPECT_EQ(again.space, Space::Platform);
  EXPECT_EQ(again.first_line, 5);
  ASSERT_EQ(again.points.rows(), 50);
  EXPECT_LE((again.points - reference.points).cwiseAbs().maxCoeff(), 0.5000001e-9);
}

/// Whatever bytes come: the whole file or an InputError naming it, and only finite points.
TEST(ReferenceFile, SurvivesRandomDamageToAFile) {
  const std::string seed_text =
      "# space: platform\r\n# period_s: 0.01\n0.1 0.2\t0.3 0.4 \r\n-0.5 6e-1 0.7 0.8\n0 0 0 0";
  const std::string alphabet("0123456789.eE+-# \t\r\n:naifx,\0\xff", 30);
  std::mt19937 random(1);
  int read = 0, refused = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text = seed_text;
    for (int edits = 1 + static_cast<int>(random() % 4); edits > 0; --edits) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.erase(at, 1 + random() % 3);
          break;
        default:
          text.insert(at, 1, alphabet[random() % alphabet.size()]);
          break;
      }
    }
    try {
      const Reference reference = parseReference(text, "file.txt");
      ASSERT_TRUE(reference.points.allFinite());
      ASSERT_GE(reference.points.rows(), 1);
      ++read;
    } catch (const InputError& error) {
      ASSERT_EQ(std::string(error.what()).rfind("file.txt:", 0), 0u) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(ReferenceFile, SkipsAByteOrderMark) {
  EXPECT_EQ(parseReference("\xEF\xBB\xBF"
                           "1 2 3 4\n",
                           "f")
                .points(0, 0),
            1.0);
  EXPECT_EQ(parseReference("\xEF\xBB\xBF# space: platform\n1 2 3 4\n", "f").space, Space::Platform);
}

TEST(ReferenceFile, NotesRemarksThatLookLikeAMistypedHeader) {
  for (const char* mistyped : {"# period: 0.02", "# period_ms: 20", "# space platform", "# spce: platform",
                               "# spaces = relative", "# Period 0.02 s"}) {
    const Reference r = parseReference(std::string(mistyped) + "\n1 2 3 4\n", "f");
    ASSERT_EQ(r.notes.size(), 1u) << mistyped;
    EXPECT_NE(r.notes[0].find("f:1: '"), std::string::npos) << r.notes[0];
    EXPECT_NE(r.notes[0].find(mistyped[2] == 's' ? "write # space: " : "write # period_s: "), std::string::npos)
        << r.notes[0];
  }
  for (const char* remark : {"# a remark", "# period of the leg", "# space: platform", "# period_s: 0.02", "# hip: 3",
                             "# space between the legs", "#"})
    EXPECT_TRUE(parseReference(std::string(remark) + "\n1 2 3 4\n", "f").notes.empty()) << remark;
}

}  // namespace
}  // namespace knee_robot::trajectory
