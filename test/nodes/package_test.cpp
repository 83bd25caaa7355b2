// The package by its own rules: catkin_lint, launch files.
#include <gtest/gtest.h>

#include <cstdlib>

namespace {

TEST(Package, CatkinLintFindsNothing) {
  EXPECT_EQ(0, std::system("cd " KNEE_SOURCE_DIR " && PATH=/usr/bin:$PATH catkin_lint --offline -W1 --strict . 2>&1"));
}

}  // namespace
