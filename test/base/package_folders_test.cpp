#include "knee_robot/base/package_folders.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdlib>
#include <string>

namespace knee_robot {
namespace {

namespace fs = std::filesystem;

/// A variable of the environment for the time of a test.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    const char* before = std::getenv(name);
    had_ = before != nullptr;
    if (had_) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() { had_ ? ::setenv(name_, before_.c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  std::string before_;
  bool had_ = false;
};

TEST(SharedFile, IsFoundFromTheProgramAloneAndEmptyWhenItIsNowhere) {
  const Variable none("ROS_PACKAGE_PATH", "");
  EXPECT_TRUE(fs::is_regular_file(sharedFile("pages/page.html")));
  EXPECT_TRUE(sharedFile("pages/no_such_page.html").empty());
  EXPECT_TRUE(sharedFile("pages").empty()) << "a folder is no file";
}

TEST(PackageFolders, AreTheGivenOneThenTheSourcesAroundThenThoseOfRos) {
  const Variable given("KNEE_ROBOT_PATH", "/given"), ros("ROS_PACKAGE_PATH", ":/one::/two");
  const fs::path source = fs::canonical(KNEE_SOURCE_DIR);
  const std::vector<fs::path> folders = packageFolders("knee_robot", source / "config" / "robots");
  EXPECT_EQ(folders, (std::vector<fs::path>{"/given", source, "/one/knee_robot", "/two/knee_robot"}));
  EXPECT_EQ(packageFolders("another", source), (std::vector<fs::path>{"/one/another", "/two/another"}));
}

}  // namespace
}  // namespace knee_robot
