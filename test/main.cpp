// main of every room's test program. --file=NAME runs the tests of the source NAME.cpp alone: ctest has one entry a
// file, so that they run side by side and fixtures that many cases share are made once. --gtest_filter chooses as usual
// where --file is not given.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace {

/// The gtest filter of all cases that were written in NAME.cpp; empty when there are none.
std::string casesOf(const std::string& name) {
  std::string filter;
  const auto& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int k = 0; k < suite.total_test_count(); ++k) {
      const testing::TestInfo& test = *suite.GetTestInfo(k);
      if (std::filesystem::path(test.file()).stem() != name) continue;
      filter += std::string(filter.empty() ? "" : ":") + test.test_suite_name() + "." + test.name();
    }
  }
  return filter;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::filesystem::current_path(KNEE_CHECKOUT);
  const std::string option = "--file=";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::string cases = word.rfind(option, 0) == 0 ? casesOf(word.substr(option.size())) : "";
    if (cases.empty()) {
      std::fprintf(stderr,
                   "%s: '%s' is neither --file=NAME of a test source NAME.cpp of this program nor an option of gtest\n",
                   argv[0], argv[i]);
      return 2;
    }
    testing::GTEST_FLAG(filter) = cases;
  }
  return RUN_ALL_TESTS();
}
