#include "knee_robot/base/file_set.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot {
namespace {

class Set : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_ + "/" + name; }
  int entries() const {
    return static_cast<int>(std::distance(std::filesystem::directory_iterator(folder_.path()), {}));
  }

  TemporaryFolder folder_;
};

TEST_F(Set, IsInPlaceWhenItIsCommittedAndNotBefore) {
  writeFileAtomically(file("model"), "old");
  FileSet files;
  files.add(file("model"), "new");
  files.add(file("report"), "of new");
  EXPECT_EQ(readFile(file("model")), "old");
  EXPECT_FALSE(std::filesystem::exists(file("report")));
  files.commit();
  EXPECT_EQ(readFile(file("model")), "new");
  EXPECT_EQ(readFile(file("report")), "of new");
  EXPECT_EQ(entries(), 2) << "a temporary file is left";
}

TEST_F(Set, LeavesTheOldFilesAndNoneOfItsOwnWhereOneCannotBeWritten) {
  writeFileAtomically(file("model"), "old");
  std::filesystem::create_directory(file("report"));
  {
    FileSet files;
    files.add(file("model"), "new");
    EXPECT_THROW(files.add(file("report"), "x"), InputError);
    EXPECT_THROW(files.add(file("nowhere/report"), "x"), InputError);
  }
  EXPECT_EQ(readFile(file("model")), "old");
  EXPECT_EQ(entries(), 2) << "a temporary file is left";
}

/// A limit of the file's size stands for a full disk.
TEST_F(Set, LeavesTheOldFilesWhereTheDiskIsFull) {
  writeFileAtomically(file("model"), "old");
  const pid_t process = ::fork();
  if (process == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      FileSet files;
      files.add(file("model"), "new");
      files.add(file("report"), std::string(5000, 'x'));
      files.commit();
    } catch (const InputError&) {
      ::_exit(0);
    }
    ::_exit(1);
  }
  int status = -1;
  ::waitpid(process, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(readFile(file("model")), "old");
  EXPECT_EQ(entries(), 1) << "a temporary file is left";
}

TEST_F(Set, RemovesWhatKilledRunsLeftBesideItsFilesAndNothingElse) {
  const pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  ::waitpid(gone, nullptr, 0);
  const std::string dead = "." + std::to_string(gone) + "-0.part",
                    alive = "." + std::to_string(::getppid()) + "-0.part";
  for (const std::string& name : {"model" + dead, "report" + dead, "model" + alive, std::string("model.part")})
    std::ofstream(file(name)) << "left";
  FileSet files;
  files.add(file("model"), "new");
  files.commit();
  EXPECT_FALSE(std::filesystem::exists(file("model" + dead)));
  for (const std::string& name : {"report" + dead, "model" + alive, std::string("model.part")})
    EXPECT_TRUE(std::filesystem::exists(file(name))) << name;
}

}  // namespace
}  // namespace knee_robot
