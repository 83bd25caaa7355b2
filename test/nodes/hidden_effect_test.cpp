// scripts/demo and its scripts/hidden_effect: what the demo says of trace's findings is true also where they are poor.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "test/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

struct Outcome {
  int status;
  std::string text;
};

Outcome script(const std::string& command) {
  Outcome outcome{};
  FILE* pipe = ::popen(("timeout 60 " KNEE_SOURCE_DIR "/scripts/" + command + " 2>&1").c_str(), "r");
  char line[512];
  while (pipe != nullptr && std::fgets(line, sizeof line, pipe) != nullptr)
    outcome.text += line;
  outcome.status = WEXITSTATUS(::pclose(pipe));
  return outcome;
}

Outcome hiddenEffect(const std::string& arguments) {
  return script("hidden_effect " + arguments);
}

/// What `hidden_effect reveal` prints for a hidden spring of 800 N/m, for a found one, and its exit status.
/// `after_N`: of all samples, and from each axis's first movement on; 3 and 4 N before.
Outcome reveal(double found_stiffness_N_per_m, double after_N, double since_moved_after_N) {
  const knee_robot::TemporaryFolder folder;
  std::ofstream(folder + "/truth.json") << R"({"name": "spring", "actuator": null, "listed": true, "seed": 1,)"
                                        << R"("parameters": {"stiffness_N_per_m": 800}})";
  std::ofstream(folder + "/report.json")
      << R"({"effects": [{"name": "spring", "actuators": [1, 2], "indistinguishable_from": [], "parameters":)"
      << R"({"stiffness_N_per_m": {"value": )" << found_stiffness_N_per_m << R"(}}}],)"
      << R"("before": {"validate": {"rms_N": [3, 4], "rms_since_moved_N": [3, 4]}},)"
      << R"("after": {"validate": {"rms_N": [)" << after_N << ", " << after_N << R"(], "rms_since_moved_N": [)"
      << since_moved_after_N << ", " << since_moved_after_N << "]}}}";
  const Outcome outcome =
      hiddenEffect("reveal --truth " + folder.path() + "/truth.json --report " + folder.path() + "/report.json");
  return outcome;
}

/// Draws the effect of a seed for a robot that `simulate`, a shell script with the simulation file in $4, plays or
/// stops.
struct Drawn {
  Outcome outcome;
  std::string truth;
};

Drawn draw(int seed, const std::string& simulate) {
  const knee_robot::TemporaryFolder folder;
  std::ofstream(folder + "/simulate") << "#!/bin/sh\n" << simulate << "\n";
  fs::permissions(folder + "/simulate", fs::perms::owner_all);
  Drawn drawn;
  drawn.outcome = hiddenEffect("draw --seed " + std::to_string(seed) +
                               " --effect spring --simulation " KNEE_SOURCE_DIR "/config/simulation/A.yaml -o " +
                               folder.path() + "/hidden.yaml --truth " + folder.path() + "/truth.json --references " +
                               folder.path() + "/path.txt --simulate " + folder.path() + "/simulate");
  std::ifstream truth(folder + "/truth.json");
  drawn.truth.assign(std::istreambuf_iterator<char>(truth), {});
  return drawn;
}

bool says(const Outcome& outcome, const std::string& words) {
  return outcome.text.find(words) != std::string::npos;
}

TEST(HiddenEffect, SaysThatANameIsRightAndItsSizeIsNot) {
  const Outcome poor = reveal(240.0, 1.0, 1.0);
  EXPECT_EQ(poor.status, 0) << poor.text;
  EXPECT_TRUE(says(poor, "800 hidden, 240 found: the name is right, the size is not")) << poor.text;
  const Outcome good = reveal(790.0, 1.0, 1.0);
  EXPECT_TRUE(says(good, "800 hidden, 790 found\n")) << good.text;
}

TEST(HiddenEffect, FailsTheDemoWhenTheHeldOutErrorDidNotFall) {
  const Outcome worse = reveal(800.0, 4.0, 4.0);
  EXPECT_EQ(worse.status, 1);
  EXPECT_TRUE(says(worse, "went UP or stayed, 3.54 -> 4.00 N")) << worse.text;
}

TEST(HiddenEffect, JudgesTheDemoFromTheFirstMovementOnAndShowsTheWholeErrorToo) {
  const Outcome down = reveal(800.0, 4.0, 2.0);
  EXPECT_EQ(down.status, 0) << down.text;
  EXPECT_TRUE(says(down,
                   "all samples, N (actuators 1 to 4, together):\n   before      3.00     4.00     3.54\n"
                   "   after       4.00     4.00     4.00\n"))
      << down.text;
  EXPECT_TRUE(says(down,
                   "first movement on, N (actuators 1 to 4, together):\n   before      3.00     4.00     3.54\n"
                   "   after       2.00     2.00     2.00\n"))
      << down.text;
  const Outcome up = reveal(800.0, 1.0, 4.0);
  EXPECT_EQ(up.status, 1) << "what it holds before it moves is luck: " << up.text;
}

TEST(HiddenEffect, HidesTheNextSeedsWhereTheDrivesCannotCarryThisOne) {
  const Drawn drawn = draw(
      31, "if [ ! -e \"$0.first\" ]; then touch \"$0.first\"; echo 'axis 2: the force was at its limit'; exit 3; fi");
  EXPECT_EQ(drawn.outcome.status, 0) << drawn.outcome.text;
  EXPECT_TRUE(
      says(drawn.outcome,
           "seed 31 hides what this robot cannot carry along these movements (axis 2: the force was at its limit)"))
      << drawn.outcome.text;
  EXPECT_NE(drawn.truth.find("\"seed\": 32"), std::string::npos) << drawn.truth;
}

TEST(HiddenEffect, SaysSoWhenTheRobotPlaysNothingAtAll) {
  const Drawn drawn = draw(31, "exit 3");
  EXPECT_EQ(drawn.outcome.status, 1);
  EXPECT_TRUE(says(drawn.outcome, "plays these movements with none of 20 effects")) << drawn.outcome.text;
}

TEST(Demo, RefusesWhatIsNoOptionOfItsInOneSentenceAndTakesTheOthersInAnyOrder) {
  const std::pair<const char*, const char*> refused[] = {
      {"--bogus", "demo: there is no option --bogus; usage: scripts/demo [--seed N] [--effect NAME] [FOLDER]\n"},
      {"--effect spring --seed three", "demo: --seed needs a whole number\n"},
      {"--seed 3 --effect --help", "demo: --effect needs a name\n"},
      {"--effect spring here --seed 3 there", "demo: two folders were given, here and there; one takes everything\n"},
  };
  for (const auto& [arguments, sentence] : refused) {
    const Outcome outcome = script(std::string("demo ") + arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(outcome.text, sentence);
  }
}

}  // namespace
