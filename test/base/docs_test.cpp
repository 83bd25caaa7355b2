#include <gtest/gtest.h>

#include <cstdlib>

namespace {

TEST(Docs, HaveEveryKeyOfEveryFileAndNameNothingThatIsGone) {
  EXPECT_EQ(0, std::system("/usr/bin/python3 " KNEE_SOURCE_DIR "/test/docs_check.py " KNEE_SOURCE_DIR));
}

}  // namespace
