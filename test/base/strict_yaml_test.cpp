#include "knee_robot/base/strict_yaml.h"

#include <gtest/gtest.h>

#include <random>

#include "knee_robot/base/errors.h"
#include "test/refusal.h"

namespace knee_robot {
namespace {

TEST(StrictMap, ReadsEveryKindOfValue) {
  StrictMap map = StrictMap::parse("a: 1.5\nb: word\nc: [1, 2]\nd: {e: true}\nf: 3\ng: [x, y]\n", "file.yaml");
  EXPECT_EQ(1.5, map.number("a", 0, 2));
  EXPECT_EQ("word", map.choice("b", {"word", "other"}));
  EXPECT_EQ((std::vector<double>{1, 2}), map.numbers("c", 2, 0, 5));
  StrictMap inner = map.map("d");
  EXPECT_TRUE(inner.flagOr("e", false));
  EXPECT_EQ(3, map.integer("f", 0, 5));
  EXPECT_EQ((std::vector<std::string>{"x", "y"}), map.texts("g"));
  EXPECT_EQ(7.0, map.numberOr("absent", 7.0, 0, 10));
  EXPECT_NO_THROW(map.finish());
}

TEST(StrictMap, RefusesByFileLineKeyValueAndLimit) {
  StrictMap map = StrictMap::parse("good: 1\nbad: 12\n", "robot.yaml");
  EXPECT_EQ("robot.yaml:2: bad: 12 is outside 0 .. 10", refusalOf([&] { map.number("bad", 0, 10); }));
  EXPECT_EQ("robot.yaml:1: unknown key good; known here: bad", refusalOf([&] { map.finish(); }));
  EXPECT_EQ("robot.yaml:1: the key gone is missing", refusalOf([&] { map.number("gone", 0, 1); }));
  EXPECT_EQ("f:1: a: expected a finite number, not '.nan'",
            refusalOf([] { StrictMap::parse("a: .nan", "f").number("a", 0, 1); }));
  EXPECT_EQ("f:2: a stands here twice; remove one", refusalOf([] { StrictMap::parse("a: 1\na: 2", "f"); }));
  EXPECT_EQ("f:1: expected `key: value` pairs here", refusalOf([] { StrictMap::parse("[1, 2]", "f"); }));
}

TEST(StrictMap, SurvivesRandomDamageToAFile) {
  const std::string whole = "mechanism: axes\nlist: [1, 2.5, -3e4]\nmap: {a: &x {k: 1}, b: *x}\ntext: 'quoted'\n";
  std::mt19937 random(7);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text = whole;
    const int edits = 1 + static_cast<int>(random() % 4);
    for (int edit = 0; edit < edits; ++edit)
      text[random() % text.size()] = static_cast<char>(random());
    try {
      StrictMap map = StrictMap::parse(text, "f");
      map.textOr("mechanism", "");
      if (map.has("list")) map.numbers("list", 0, -1e9, 1e9);
      if (map.has("map")) map.map("map").finish();
      map.finish();
      ++accepted;
    } catch (const InputError&) {
    }
  }
  EXPECT_LT(accepted, 20000);
}

TEST(StrictMap, RefusesASecondDocumentThatNobodyWouldRead) {
  EXPECT_EQ(
      "robot.yaml:3: a second YAML document begins above this line (---), and only one is read; remove one, or "
      "the line ---",
      refusalOf([] { StrictMap::parse("a: 1\n---\nb: 2\n", "robot.yaml"); }));
  for (const char* one : {"---\na: 1\n", "a: 1\n---\n", "%YAML 1.2\n---\na: 1\n...\n"})
    EXPECT_EQ("", refusalOf([&] { StrictMap::parse(one, "robot.yaml"); })) << one;
}

}  // namespace
}  // namespace knee_robot
