#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace {

const std::string kCheck = "/usr/bin/python3 " KNEE_SOURCE_DIR "/test/floors_check.py ";

TEST(SourceTree, IncludesGoDownTheFloorsFilesStayShortAndAClassHasOneSource) {
  EXPECT_EQ(0, std::system((kCheck + KNEE_SOURCE_DIR).c_str()));
}

TEST(SourceTree, WithAClassInTwoSourcesIsRefusedAndANestedOneHasItsOwn) {
  char pattern[] = "/tmp/floors_test_XXXXXX";
  const std::filesystem::path folder = mkdtemp(pattern);
  const std::filesystem::path room = folder / "src" / "rt";
  std::filesystem::create_directories(room);
  std::ofstream(room / "one.cpp") << "void Thing::begin() {\n}\n";
  std::ofstream(room / "other.cpp") << "int Thing::Part::count() {\n}\n";
  EXPECT_EQ(0, std::system((kCheck + folder.string() + " > /dev/null").c_str()));
  std::ofstream(room / "other.cpp") << "const std::vector<int>& knee_robot::Thing::all() const {\n}\n";
  EXPECT_NE(0, std::system((kCheck + folder.string() + " > /dev/null").c_str()));
  std::filesystem::remove_all(folder);
}

}  // namespace
