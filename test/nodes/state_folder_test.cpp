#include "../../src/nodes/state_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "knee_robot/base/files.h"

namespace knee_robot::nodes {
namespace {

class StateFolder : public ::testing::Test {
 protected:
  StateFolder() {
    makeFolder(black_box);
    writeFileAtomically(black_box + "/patient.txt", "before");
  }
  ~StateFolder() override { std::filesystem::remove_all(folder); }

  const std::string folder = ::testing::TempDir() + "state_folder_" + std::to_string(::getpid());
  const std::string black_box = folder + "/recordings/black_box", state = folder + "/state/left";
};

TEST_F(StateFolder, TakesWhatIsStillWithTheRecordings) {
  EXPECT_EQ(keptIn(state, black_box, "patient.txt"), state + "/patient.txt");
  EXPECT_EQ(readFile(state + "/patient.txt"), "before");
  EXPECT_FALSE(std::filesystem::exists(black_box + "/patient.txt")) << "deleting recordings forgets nobody";
}

TEST_F(StateFolder, BelievesItsOwnFileWhereThereAreTwo) {
  makeFolder(state);
  writeFileAtomically(state + "/patient.txt", "now");
  EXPECT_EQ(readFile(keptIn(state, black_box, "patient.txt")), "now");
  EXPECT_TRUE(std::filesystem::exists(black_box + "/patient.txt"));
}

TEST_F(StateFolder, MakesNoFileWhereThereWasNone) {
  EXPECT_EQ(keptIn(state, black_box, "heat.yaml"), state + "/heat.yaml");
  EXPECT_FALSE(std::filesystem::exists(state + "/heat.yaml"));
  EXPECT_EQ(keptIn(black_box, black_box, "patient.txt"), black_box + "/patient.txt");
  EXPECT_EQ(readFile(black_box + "/patient.txt"), "before");
}

}  // namespace
}  // namespace knee_robot::nodes
