// The words that programs understand, whatever parses them.
#include "src/nodes/command_line.h"

#include <gtest/gtest.h>

#include <optional>

#include "knee_robot/base/errors.h"

namespace knee_robot::nodes {
namespace {

enum class Colour { Red, Blue };

struct Given {
  double length = 1.5;
  int axis = 0;
  std::string space = "actuator";
  std::vector<std::string> joints;
  std::vector<double> start;
  std::optional<double> mass;
  double free = 0.0;
  std::size_t seed = 1;
  Colour colour = Colour::Red;
  bool limits = true;
  bool markers_given = false;
};

Given parse(std::vector<const char*> words) {
  Given given;
  std::string markers, map;
  CommandLine line("does something", "thing");
  line.option("--length", given.length, "length, m").within(0.0, 2.0).showDefault();
  line.option("--axis", given.axis, "axis").within(0, 4);
  line.option("--space", given.space, "space").oneOf({"actuator", "platform"});
  line.option("--joints", given.joints, "joints").separatedBy(',');
  line.option("--start", given.start, "start").values(2);
  line.option("--mass", given.mass, "mass, kg");
  line.option("--free", given.free, "any number");
  line.option("--seed", given.seed, "random seed");
  line.choice("--colour", given.colour, "colour", {{"red", Colour::Red}, {"blue", Colour::Blue}});
  line.flag("!--no-limits", given.limits, "no limits");
  const Option marked = line.option("--markers", markers, "markers");
  line.option("--map", map, "map of the markers").needs(marked);
  words.insert(words.begin(), "thing");
  int status = -1;
  EXPECT_TRUE(line.parse(static_cast<int>(words.size()), words.data(), status));
  given.markers_given = marked.given();
  return given;
}

std::string whyRefused(const std::vector<const char*>& words) {
  try {
    parse(words);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CommandLine, LeavesWhatIsNotGivenAsItWas) {
  const Given given = parse({});
  EXPECT_EQ(given.length, 1.5);
  EXPECT_EQ(given.colour, Colour::Red);
  EXPECT_TRUE(given.limits);
  EXPECT_FALSE(given.markers_given);
}

TEST(CommandLine, TakesWhatIsGiven) {
  const Given given = parse({"--length", "0.25", "--axis", "4", "--space", "platform", "--joints", "a,b", "--start",
                             "-1", "2", "--colour", "BLUE", "--no-limits", "--markers", "m.csv", "--map", "m.yaml"});
  EXPECT_EQ(given.length, 0.25);
  EXPECT_EQ(given.axis, 4);
  EXPECT_EQ(given.space, "platform");
  EXPECT_EQ(given.joints, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(given.start, (std::vector<double>{-1.0, 2.0}));
  EXPECT_EQ(given.colour, Colour::Blue);
  EXPECT_FALSE(given.limits);
  EXPECT_TRUE(given.markers_given);
}

TEST(CommandLine, RefusesWhatIsOutsideARangeOrAList) {
  EXPECT_NE(whyRefused({"--length", "2.5"}).find("2.5 not in range"), std::string::npos)
      << whyRefused({"--length", "2.5"});
  EXPECT_NE(whyRefused({"--axis", "5"}), "");
  EXPECT_NE(whyRefused({"--axis", "1.5"}), "");
  EXPECT_NE(whyRefused({"--space", "pose"}).find("actuator,platform"), std::string::npos);
  EXPECT_NE(whyRefused({"--colour", "green"}).find("red,blue"), std::string::npos);
  EXPECT_NE(whyRefused({"--start", "1"}), "");
  EXPECT_NE(whyRefused({"--map", "m.yaml"}).find("--markers"), std::string::npos);
}

TEST(CommandLine, TakesNoNegativeSeedForALargeOne) {
  EXPECT_NE(whyRefused({"--seed", "-1"}).find("-1 is negative"), std::string::npos) << whyRefused({"--seed", "-1"});
  EXPECT_EQ(parse({"--seed", "18446744073709551615"}).seed, 18446744073709551615u);
}

TEST(CommandLine, TakesNoOptionForTheValueOfTheOneBefore) {
  for (const char* const option : {"--joints", "--markers"}) {
    const std::string why = whyRefused({option, "--no-limits"});
    EXPECT_NE(why.find("the next option, --no-limits, stands in its place"), std::string::npos) << why;
  }
  EXPECT_EQ(parse({"--joints", "--what"}).joints, std::vector<std::string>{"--what"});
}

TEST(CommandLine, TakesNoNumberThatIsNotFinite) {
  for (const char* const word : {"nan", "-nan", "NaN", "inf", "-inf", "infinity", "1e999"}) {
    for (const char* const option : {"--length", "--free", "--mass"}) {
      const std::string why = whyRefused({option, word});
      EXPECT_NE(why.find(option), std::string::npos) << option << " " << word << ": " << why;
    }
    EXPECT_NE(whyRefused({"--start", "1", word}), "") << word;
    EXPECT_NE(whyRefused({"--axis", word}), "") << word;
  }
  EXPECT_NE(whyRefused({"--free", "nan"}).find("nan is not a finite number"), std::string::npos);
  EXPECT_EQ(parse({"--free", "-1e300", "--mass", "2"}).free, -1e300);
}

}  // namespace
}  // namespace knee_robot::nodes
