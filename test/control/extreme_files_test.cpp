// Files of robot, hardware and deployment that are well formed and say something absurd: refused in a sentence, or safe.
#include <filesystem>
#include <regex>

#include "files_of_a_robot.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using namespace mistaken;

/// Each number of `text` (of actuators those of axes 1 and 4 only) in turn, in the place of which `put` stands.
template <typename Check>
void withEachNumber(const std::string& text, const std::function<std::string(double)>& put, Check&& check) {
  const std::regex number("([:\\[,] +|\\[)(-?[0-9]+\\.?[0-9]*(e[0-9]+)?)(?=[,}\\]\\n])");
  int line = 1;
  std::size_t counted = 0;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), number); it != std::sregex_iterator(); ++it) {
    const auto at = static_cast<std::size_t>(it->position(2));
    line += static_cast<int>(
        std::count(text.begin() + static_cast<long>(counted), text.begin() + static_cast<long>(at), '\n'));
    counted = at;
    const std::size_t begin = text.rfind('\n', at) + 1;
    // Of the singularity margin "no limit" is allowed.
    if (text[begin] == '#' || text.compare(begin, 19, "singularity_margin:") == 0) continue;
    std::string changed = text;
    const std::string instead = put(std::stod((*it)[2].str()));
    changed.replace(at, static_cast<std::size_t>((*it)[2].length()), instead);
    check(changed, std::to_string(line) + ": " + (*it)[2].str() + " -> " + instead);
  }
}

/// As a file in a folder of its own.
class ExtremeFile : public ::testing::TestWithParam<std::string> {
 protected:
  ExtremeFile() {
    text = readFile(target());
    const std::string urdf = std::filesystem::absolute(holding::file("urdf/A.urdf")).string();
    text = std::regex_replace(text, std::regex("urdf: \\S+"), "urdf: " + urdf);
    target() = folder + "/" + GetParam() + ".yaml";
  }
  std::string& target() {
    return GetParam() == "robot" ? files.robot : GetParam() == "hardware" ? files.hardware : files.deployment;
  }
  Outcome outcome(const std::string& changed) {
    writeFileAtomically(target(), changed);
    return outcomeOf(files);
  }

  const TemporaryFolder folder;
  Files files;
  std::string text;
};

TEST_P(ExtremeFile, WithANumberThatIsNoneOrTooLargeIsRefusedWithItsName) {
  for (const char* instead : {".nan", ".inf", "-.inf", "1e308", "-1e308", "1e400"}) {
    withEachNumber(
        text, [&](double) { return instead; },
        [&](const std::string& changed, const std::string& where) {
          const Outcome now = outcome(changed);
          EXPECT_EQ(now.refusal.rfind(target() + ":", 0), 0u) << where << ": " << now.refusal;
        });
  }
}

TEST_P(ExtremeFile, InOtherUnitsIsRefusedOrStopsBeforeALegHasGoneFar) {
  double farthest = 0.0;
  for (const double factor : {1000.0, 0.001, -1.0, 0.0}) {
    const auto times = [&](double was) {
      std::array<char, 32> number{};
      std::snprintf(number.data(), number.size(), "%.10g", factor * was);
      return std::string(number.data());
    };
    withEachNumber(text, times, [&](const std::string& changed, const std::string& where) {
      const Outcome now = outcome(changed);
      // Once 397 mm, with a screw's lead in another unit. A wrong sign takes a leg along by up to 17 mm.
      EXPECT_LT(now.leg_m, 0.025) << GetParam() << ", line " << where;
      EXPECT_TRUE(now.ends_off) << GetParam() << ", line " << where;
      farthest = std::max(farthest, now.leg_m);
    });
  }
  std::printf("a leg goes %.1f mm at most\n", 1e3 * farthest);
}

TEST_P(ExtremeFile, SavedByOtherProgramsIsReadOrRefusedInOneLine) {
  const std::string first_key = GetParam() == "robot"      ? "mechanism"
                                : GetParam() == "hardware" ? "backend"
                                                           : "components";
  const std::vector<std::string> texts = {"\xEF\xBB\xBF" + text,
                                          std::regex_replace(text, std::regex("\n"), "\r\n"),
                                          "\t" + text,
                                          text + "\n\t\n",
                                          text + "\n" + first_key + ": 1\n",
                                          text + "\n---\n" + text,
                                          text + std::string(1, '\0'),
                                          text.substr(0, 400),
                                          "",
                                          "[]",
                                          "&a [*a]",
                                          std::regex_replace(text, std::regex(" \\{"), " {{")};
  for (const std::string& one : texts) {
    const Outcome now = outcome(one);
    EXPECT_EQ(now.refusal.find('\n'), std::string::npos) << now.refusal;
    EXPECT_LT(now.leg_m, 0.025);
    EXPECT_TRUE(now.refusal.empty() || now.refusal.rfind(target() + ":", 0) == 0) << now.refusal;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, ExtremeFile, ::testing::Values("robot", "hardware", "deployment"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace knee_robot::control
