// A model that is judged and one that is fed forward are the same.
#include "src/control/unchanged_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>

namespace knee_robot::control {
namespace {

TEST(UnchangedFile, RefusesOneThatIsAnotherByTheEnd) {
  const std::string path = ::testing::TempDir() + "unchanged_" + std::to_string(::getpid()) + ".yaml";
  writeFileAtomically(path, "format: 4\n");
  const UnchangedFile file(path);
  EXPECT_NO_THROW(file.require());
  writeFileAtomically(path, "format: 4\n");
  EXPECT_NO_THROW(file.require()) << "written again, the same";
  writeFileAtomically(path, "format: 3\n");
  EXPECT_THROW(file.require(), InputError);
  std::remove(path.c_str());
  EXPECT_THROW(file.require(), InputError);
  EXPECT_THROW(UnchangedFile{path}, InputError);
  EXPECT_NO_THROW(UnchangedFile{""}.require()) << "no model";
}

}  // namespace
}  // namespace knee_robot::control
