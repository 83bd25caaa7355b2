// scripts/set_up_industrial_pc, as far as it goes without a machine to change.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include "test/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using knee_robot::TemporaryFolder;

const std::string kFiles =
    " --robot config/robots/final.yaml --urdf urdf/final.urdf --hardware config/hardware/cards.yaml";

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
  const TemporaryFolder folder;
  ASSERT_EQ(runScript("--into " + folder.path() +
                      " --cpus 2,3 --user robot --robot /etc/knee/my_robot.yaml --urdf /etc/knee/my_robot.urdf "
                      "--hardware /etc/knee/cards.yaml"),
            0);
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
    if (!entry.is_regular_file()) continue;
    ++files;
    const std::string content = contentOf(entry.path());
    EXPECT_FALSE(std::regex_search(content, std::regex("@[A-Z_]+@"))) << entry.path() << ":\n" << content;
  }
  EXPECT_EQ(files, 6);
  const std::string guardian = contentOf(folder / "etc/systemd/system/knee-guardian.service");
  EXPECT_NE(guardian.find("User=robot\n"), std::string::npos);
  EXPECT_NE(guardian.find("--hardware /etc/knee/cards.yaml"), std::string::npos);
  EXPECT_NE(guardian.find("--cpu 3"), std::string::npos);
  const std::string controller = contentOf(folder / "etc/systemd/system/knee-controller.service");
  EXPECT_NE(controller.find(" robot:=/etc/knee/my_robot.yaml urdf:=/etc/knee/my_robot.urdf "), std::string::npos);
  EXPECT_NE(controller.find(" cpu:=2 "), std::string::npos);
}

TEST(SetUpIndustrialPc, NeverRestartsAControllerThatDied) {
  const TemporaryFolder folder;
  ASSERT_EQ(runScript("--into " + folder.path() + " --cpus 2,3" + kFiles), 0);
  const std::string controller = contentOf(folder / "etc/systemd/system/knee-controller.service");
  EXPECT_NE(controller.find("\nRestart=no\n"), std::string::npos);
  EXPECT_NE(controller.find("\nExecStopPost="), std::string::npos);
}

TEST(SetUpIndustrialPc, NamesFilesByTheirWholePaths) {
  const TemporaryFolder folder;
  ASSERT_EQ(runScript("--into " + folder.path() + " --cpus 2,3" + kFiles), 0);
  const std::string guardian = contentOf(folder / "etc/systemd/system/knee-guardian.service");
  const std::size_t begin = guardian.find("--hardware ") + 11;
  EXPECT_TRUE(fs::exists(guardian.substr(begin, guardian.find(' ', begin) - begin)));
}

TEST(SetUpIndustrialPc, RefusesOneProcessorForBothAndUnknownArguments) {
  EXPECT_EQ(runScript("--into /nonexistent --cpus 2,2" + kFiles), 2);
  EXPECT_EQ(runScript("--into /nonexistent --cpus two" + kFiles), 2);
  EXPECT_EQ(runScript("--user 'a b' --into /nonexistent" + kFiles), 2);
  EXPECT_EQ(runScript("--everything"), 2);
}

TEST(SetUpIndustrialPc, HasNoDefaultForWhatBelongsToTheMachine) {
  const TemporaryFolder folder;
  const std::string into = "--into " + folder.path() + " --cpus 2,3";
  EXPECT_EQ(runScript(into + " --urdf urdf/final.urdf --hardware config/hardware/cards.yaml"), 2);
  EXPECT_EQ(runScript(into + " --robot config/robots/final.yaml --hardware config/hardware/cards.yaml"), 2);
  EXPECT_EQ(runScript(into + " --robot config/robots/final.yaml --urdf urdf/final.urdf"), 2);
  EXPECT_EQ(runScript(into + " --robot '/etc/a b.yaml' --urdf urdf/final.urdf --hardware config/hardware/cards.yaml"),
            2);
}

TEST(SetUpIndustrialPc, SaysThatThisMachineIsNoIndustrialPc) {
  EXPECT_EQ(runScript("--check" + kFiles), 1);
}

}  // namespace
