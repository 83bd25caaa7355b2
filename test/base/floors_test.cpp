#include <gtest/gtest.h>

#include <cstdlib>

TEST(SourceTree, IncludesGoDownTheFloorsAndFilesStayShort) {
  EXPECT_EQ(0, std::system("/usr/bin/python3 " KNEE_SOURCE_DIR "/test/floors_check.py " KNEE_SOURCE_DIR));
}
