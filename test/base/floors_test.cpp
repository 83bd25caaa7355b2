#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "test/temporary_folder.h"

namespace {

const std::string kCheck = "/usr/bin/python3 " KNEE_SOURCE_DIR "/test/floors_check.py ";
const std::string kHiddenNames = "/usr/bin/python3 " KNEE_SOURCE_DIR "/test/hidden_names_check.py ";

TEST(SourceTree, IncludesGoDownTheFloorsFilesStayShortAndAClassHasOneSource) {
  EXPECT_EQ(0, std::system((kCheck + KNEE_SOURCE_DIR).c_str()));
}

TEST(SourceTree, WithAClassInTwoSourcesIsRefusedAndANestedOneHasItsOwn) {
  const knee_robot::TemporaryFolder folder;
  const std::filesystem::path room = folder / "src" / "rt";
  std::filesystem::create_directories(room);
  std::ofstream(room / "one.cpp") << "void Thing::begin() {\n}\n";
  std::ofstream(room / "other.cpp") << "int Thing::Part::count() {\n}\n";
  EXPECT_EQ(0, std::system((kCheck + folder.path() + " > /dev/null").c_str()));
  std::ofstream(room / "other.cpp") << "const std::vector<int>& knee_robot::Thing::all() const {\n}\n";
  EXPECT_NE(0, std::system((kCheck + folder.path() + " > /dev/null").c_str()));
}

TEST(SourceTree, HasNoSourceThatHidesAHeadersName) {
  EXPECT_EQ(0, std::system((kHiddenNames + KNEE_SOURCE_DIR).c_str()));
}

TEST(SourceTree, WithASourceThatHidesAHeadersNameIsRefused) {
  const knee_robot::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "src");
  std::ofstream(folder / "src" / "a.h") << "namespace knee_robot::rt {\n\ninline constexpr int kBlocks = 10;\n"
                                           "double rms(double value);\n\n}  // namespace knee_robot::rt\n";
  const auto withSource = [&](const std::string& own) {
    std::ofstream(folder / "src" / "b.cpp")
        << "namespace knee_robot::rt {\nnamespace {\n\n" + own +
               "\n\n}  // namespace\n\nint kBlocks();\n\n}  // namespace knee_robot::rt\n";
    return std::system((kHiddenNames + folder.path() + " > /dev/null").c_str());
  };
  EXPECT_EQ(0, withSource("constexpr int kPieces = 8;"));
  EXPECT_NE(0, withSource("constexpr int kPieces = 1, kBlocks = 8;"));
  EXPECT_NE(0, withSource("double rms(const double& value) {\n  return value;\n}"));
}

}  // namespace
