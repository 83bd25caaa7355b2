// The package by its own rules: catkin_lint, and a configuration on a machine that has only what the demo installs.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

TEST(Package, CatkinLintFindsNothing) {
  EXPECT_EQ(0, std::system("cd " KNEE_SOURCE_DIR " && PATH=/usr/bin:$PATH catkin_lint --offline -W1 --strict . 2>&1"));
}

TEST(Package, IsConfiguredWithoutTheLibrariesThatOnlyDevelopersHave) {
  std::string folder = (std::filesystem::temp_directory_path() / "knee_without_developers_XXXXXX").string();
  ASSERT_NE(nullptr, mkdtemp(folder.data()));
  std::string command = "cmake -S " KNEE_SOURCE_DIR " -B " + folder +
                        " -G Ninja -DCATKIN_ENABLE_TESTING=OFF -DCATKIN_DEVEL_PREFIX=" + folder + "/devel";
  for (const char* package : {"benchmark", "Simbody", "GTest", "rostest", "orocos_kdl", "kdl_parser"}) {
    command += std::string(" -DCMAKE_DISABLE_FIND_PACKAGE_") + package + "=ON";
  }
  EXPECT_EQ(0,
            std::system((command + " > " + folder + "/log 2>&1 || { tail -n 20 " + folder + "/log; false; }").c_str()));
  std::filesystem::remove_all(folder);
}

}  // namespace
