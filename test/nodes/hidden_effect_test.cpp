// scripts/hidden_effect: what the demo says of trace's findings is true also where they are poor.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

namespace fs = std::filesystem;

struct Outcome {
  int status;
  std::string text;
};

/// What `hidden_effect reveal` prints for a hidden spring of 800 N/m, for a found one, and its exit status.
Outcome reveal(double found_stiffness_N_per_m, double after_N) {
  std::string folder = (fs::temp_directory_path() / "knee_hidden_effect_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return {-1, "no folder"};
  std::ofstream(folder + "/truth.json") << R"({"name": "spring", "actuator": null, "listed": true, "seed": 1,)"
                                        << R"("parameters": {"stiffness_N_per_m": 800}})";
  std::ofstream(folder + "/report.json")
      << R"({"effects": [{"name": "spring", "actuators": [1, 2], "indistinguishable_from": [], "parameters":)"
      << R"({"stiffness_N_per_m": {"value": )" << found_stiffness_N_per_m << R"(}}}],)"
      << R"("before": {"validate": {"rms_N": [3, 4]}}, "after": {"validate": {"rms_N": [)" << after_N << ", " << after_N
      << "]}}}";
  const std::string command = KNEE_SOURCE_DIR "/scripts/hidden_effect reveal --truth " + folder +
                              "/truth.json --report " + folder + "/report.json 2>&1";
  Outcome outcome{};
  FILE* pipe = ::popen(command.c_str(), "r");
  char line[512];
  while (pipe != nullptr && std::fgets(line, sizeof line, pipe) != nullptr)
    outcome.text += line;
  outcome.status = WEXITSTATUS(::pclose(pipe));
  fs::remove_all(folder);
  return outcome;
}

bool says(const Outcome& outcome, const std::string& words) {
  return outcome.text.find(words) != std::string::npos;
}

TEST(HiddenEffect, SaysThatANameIsRightAndItsSizeIsNot) {
  const Outcome poor = reveal(240.0, 1.0);
  EXPECT_EQ(poor.status, 0) << poor.text;
  EXPECT_TRUE(says(poor, "800 hidden, 240 found: the name is right, the size is not")) << poor.text;
  const Outcome good = reveal(790.0, 1.0);
  EXPECT_TRUE(says(good, "800 hidden, 790 found\n")) << good.text;
}

TEST(HiddenEffect, FailsTheDemoWhenTheHeldOutErrorDidNotFall) {
  const Outcome worse = reveal(800.0, 4.0);
  EXPECT_EQ(worse.status, 1);
  EXPECT_TRUE(says(worse, "went UP or stayed")) << worse.text;
}

}  // namespace
