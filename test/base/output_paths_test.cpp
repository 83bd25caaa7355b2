#include "knee_robot/base/output_paths.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "knee_robot/base/errors.h"
#include "test/temporary_folder.h"

namespace knee_robot {
namespace {

namespace fs = std::filesystem;

class OutputPaths : public ::testing::Test {
 protected:
  OutputPaths() { std::ofstream(file("run.csv")) << "x"; }
  ~OutputPaths() override {
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "looking has left something";
  }
  std::string file(const std::string& name) const { return folder_ + "/" + name; }

  TemporaryFolder folder_;
};

TEST_F(OutputPaths, AreWritableWhereAFileCanBeMade) {
  EXPECT_NO_THROW(requireWritable(file("new.csv")));
  EXPECT_NO_THROW(requireWritable(file("run.csv")));
  EXPECT_THROW(requireWritable(file("no/new.csv")), InputError);
  EXPECT_THROW(requireWritable(folder_), InputError);
  EXPECT_THROW(requireWritable("/proc/new.csv"), InputError);
  EXPECT_THROW(requireWritable("/dev/null"), InputError) << "a device would be replaced by a file";
  EXPECT_THROW(requireWritable(""), InputError);
}

TEST_F(OutputPaths, AreNewWhereNothingIs) {
  EXPECT_NO_THROW(requireNew(file("new.csv")));
  EXPECT_THROW(requireNew(file("run.csv")), InputError);
}

TEST_F(OutputPaths, TakeAFolderThatIsThereOrCanBeMade) {
  EXPECT_NO_THROW(requireWritableFolder(folder_));
  EXPECT_NO_THROW(requireWritableFolder(file("a/b/")));
  EXPECT_NO_THROW(requireWritableFolder("."));
  EXPECT_THROW(requireWritableFolder(file("run.csv")), InputError);
  EXPECT_THROW(requireWritableFolder(file("run.csv/below")), InputError);
  EXPECT_THROW(requireWritableFolder("/proc/out"), InputError);
  EXPECT_THROW(requireWritableFolder(""), InputError);
}

TEST_F(OutputPaths, AreNotTheInputsUnderAnyName) {
  const std::string run = file("run.csv");
  EXPECT_NO_THROW(requireNoneOverwritten({run, ""}, {file("other.csv")}));
  EXPECT_NO_THROW(requireNoneOverwritten({file("absent")}, {file("other.csv")}));
  EXPECT_THROW(requireNoneOverwritten({run}, {run}), InputError);
  EXPECT_THROW(requireNoneOverwritten({run}, {file("a/../run.csv")}), InputError);
  fs::create_symlink(run, file("link.csv"));
  fs::create_directory_symlink(folder_.path(), file("folder"));
  EXPECT_THROW(requireNoneOverwritten({file("link.csv")}, {run}), InputError);
  EXPECT_THROW(requireNoneOverwritten({run}, {file("folder/run.csv")}), InputError);
  fs::remove(file("link.csv"));
  fs::remove(file("folder"));
}

}  // namespace
}  // namespace knee_robot
