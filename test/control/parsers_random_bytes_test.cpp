// Files come from people, editors and broken disks: every reader either takes them or refuses them with its own errors.
// The same readers are fuzzed for longer by scripts/fuzz; this is the short, deterministic part of it.
#include <gtest/gtest.h>

#include <random>

#include "test/fuzz/parsers.h"

namespace knee_robot::fuzz {
namespace {

constexpr int kRounds = 400;

std::string randomBytes(std::mt19937& random) {
  std::string text(random() % 300, '\0');
  for (char& one : text)
    one = static_cast<char>(random());
  return text;
}

/// A good file with a few things done to it that editors, transfers and people do.
std::string damaged(std::string text, std::mt19937& random) {
  static const char* kInserts[] = {
      "nan", "-inf", "1e999", "\r", "\0", "{", "]", ": ", "- ", "&a [*a]", "999999999999999999", "\xEF\xBB\xBF"};
  for (unsigned changes = 1 + random() % 4; changes > 0 && !text.empty(); --changes) {
    const std::size_t at = random() % text.size();
    switch (random() % 6) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text.resize(at);
        break;
      case 2:
        text.insert(at, kInserts[random() % std::size(kInserts)]);
        break;
      case 3:
        text.erase(at, random() % 20);
        break;
      case 4:
        text.insert(at, text.substr(random() % text.size(), random() % 60));
        break;
      case 5: {  // another number
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit != std::string::npos) text[digit] = "0123456789-.e"[random() % 13];
        break;
      }
    }
  }
  return text;
}

class ParserTest : public testing::TestWithParam<Parser> {};

TEST_P(ParserTest, takesOrRefusesRandomBytesAndDamagedFilesWithItsOwnErrorsOnly) {
  const Parser& parser = GetParam();
  std::mt19937 random(20250101);
  std::vector<std::string> seeds;
  for (const std::string& seed : parser.seeds)
    seeds.push_back(seedText(seed));
  for (int round = 0; round < kRounds; ++round) {
    const std::string text = round % 4 == 0 ? randomBytes(random) : damaged(seeds[random() % seeds.size()], random);
    ASSERT_NO_THROW(feed(parser, text)) << parser.name << ", round " << round << ":\n" << text;
  }
}

TEST_P(ParserTest, takesOrRefusesEmptyAndVeryLongInput) {
  const Parser& parser = GetParam();
  for (const std::string& text : {std::string(), std::string("\n"), std::string(1, '\0'), std::string(100000, '['),
                                  std::string(100000, '1'), std::string(100000, '\n'), std::string(50000, ' ') + "1"})
    ASSERT_NO_THROW(feed(parser, text)) << parser.name << ", " << text.size() << " bytes";
}

INSTANTIATE_TEST_SUITE_P(AllParsers, ParserTest, testing::ValuesIn(parsers()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace knee_robot::fuzz
