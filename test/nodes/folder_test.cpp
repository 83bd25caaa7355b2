#include "../../src/nodes/folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::nodes {
namespace {

namespace fs = std::filesystem;

class FolderTest : public testing::Test {
 protected:
  FolderTest()
      : top_(fs::temp_directory_path() / ("knee_folder_" + std::to_string(getpid()))), folder_((top_ / "in").string()) {
    fs::create_directories(top_ / "in" / "below");
    fs::create_directories(top_ / "inside_out");
    for (const char* name : {"in/a.txt", "in/below/b.txt", "secret.txt", "inside_out/c.txt"})
      writeFileAtomically(top_ / name, "x");
    fs::create_symlink(top_ / "secret.txt", top_ / "in" / "link.txt");
    fs::create_symlink(top_, top_ / "in" / "up");
  }
  ~FolderTest() override { fs::remove_all(top_); }

  fs::path top_;
  Folder folder_;
};

TEST_F(FolderTest, GivesItsOwnFiles) {
  EXPECT_EQ((fs::canonical(top_) / "in/a.txt").string(), folder_.existingFile("a.txt"));
  EXPECT_EQ((fs::canonical(top_) / "in/below/b.txt").string(), folder_.existingFile("below/../below/b.txt"));
  EXPECT_EQ((fs::canonical(top_) / "in/a.txt").string(), folder_.existingFile((top_ / "in/a.txt").string()));
}

TEST_F(FolderTest, GivesNothingElse) {
  for (const std::string& name :
       {std::string("../secret.txt"), std::string("link.txt"), std::string("up/secret.txt"), std::string("/etc/passwd"),
        (top_ / "inside_out/c.txt").string(), std::string("../inside_out/c.txt"), std::string("below"), std::string(""),
        std::string("absent.txt"), std::string("a.txt\0.txt", 9), std::string(5000, 'a')}) {
    EXPECT_THROW(folder_.existingFile(name), InputError) << name;
  }
}

TEST_F(FolderTest, MakesPlainNewNamesOnly) {
  EXPECT_EQ((fs::canonical(top_) / "in/new-1_x.csv").string(), folder_.newFile("new-1_x.csv"));
  for (const char* name : {"", ".hidden", "../x.csv", "below/x.csv", "/tmp/x.csv", "a b.csv", "a.txt", "link.txt"}) {
    EXPECT_THROW(folder_.newFile(name), InputError) << name;
  }
}

}  // namespace
}  // namespace knee_robot::nodes
