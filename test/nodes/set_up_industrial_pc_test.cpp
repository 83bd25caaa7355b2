// scripts/set_up_industrial_pc, as far as it goes without a machine to change.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;

struct Folder {
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "knee_industrial_pc_XXXXXX").string();
    path = ::mkdtemp(pattern.data());
  }
  ~Folder() { fs::remove_all(path); }
  fs::path path;
};

int runScript(const std::string& arguments) {
  const std::string command = KNEE_SOURCE_DIR "/scripts/set_up_industrial_pc " + arguments + " > /dev/null 2>&1";
  return WEXITSTATUS(std::system(command.c_str()));
}

std::string contentOf(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(SetUpIndustrialPc, FillsInEveryPlaceOfItsFiles) {
  const Folder folder;
  ASSERT_EQ(runScript("--into " + folder.path.string() + " --cpus 2,3 --user robot --hardware /etc/knee/robot.yaml"),
            0);
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path)) {
    if (!entry.is_regular_file()) continue;
    ++files;
    const std::string content = contentOf(entry.path());
    EXPECT_EQ(content.find("@CPU"), std::string::npos) << entry.path();
    EXPECT_EQ(content.find("@OTHER"), std::string::npos) << entry.path();
    EXPECT_EQ(content.find("@HARD"), std::string::npos) << entry.path();
    EXPECT_EQ(content.find("@BUILD"), std::string::npos) << entry.path();
  }
  EXPECT_EQ(files, 6);
  const std::string guardian = contentOf(folder.path / "etc/systemd/system/knee-guardian.service");
  EXPECT_NE(guardian.find("User=robot\n"), std::string::npos);
  EXPECT_NE(guardian.find("--hardware /etc/knee/robot.yaml"), std::string::npos);
  EXPECT_NE(guardian.find("--cpu 3"), std::string::npos);
}

TEST(SetUpIndustrialPc, NeverRestartsAControllerThatDied) {
  const Folder folder;
  ASSERT_EQ(runScript("--into " + folder.path.string() + " --cpus 2,3"), 0);
  const std::string controller = contentOf(folder.path / "etc/systemd/system/knee-controller.service");
  EXPECT_NE(controller.find("\nRestart=no\n"), std::string::npos);
  EXPECT_NE(controller.find("\nExecStopPost="), std::string::npos);
}

TEST(SetUpIndustrialPc, NamesAHardwareFileThatIsThereUnlessToldAnother) {
  const Folder folder;
  ASSERT_EQ(runScript("--into " + folder.path.string() + " --cpus 2,3"), 0);
  const std::string guardian = contentOf(folder.path / "etc/systemd/system/knee-guardian.service");
  const std::size_t begin = guardian.find("--hardware ") + 11;
  EXPECT_TRUE(fs::exists(guardian.substr(begin, guardian.find(' ', begin) - begin)));
}

TEST(SetUpIndustrialPc, RefusesOneProcessorForBothAndUnknownArguments) {
  EXPECT_EQ(runScript("--into /nonexistent --cpus 2,2"), 2);
  EXPECT_EQ(runScript("--into /nonexistent --cpus two"), 2);
  EXPECT_EQ(runScript("--user 'a b' --into /nonexistent"), 2);
  EXPECT_EQ(runScript("--everything"), 2);
}

TEST(SetUpIndustrialPc, SaysThatThisMachineIsNoIndustrialPc) {
  EXPECT_EQ(runScript("--check --hardware /nonexistent.yaml"), 1);
}

}  // namespace
