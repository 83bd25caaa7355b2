#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <clocale>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/file_name.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"

namespace knee_robot {
namespace {

class Files : public testing::Test {
 protected:
  Files() : folder_(std::filesystem::temp_directory_path() / ("knee_base_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~Files() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST(ParseFinite, AcceptsNumbersAndNothingElse) {
  EXPECT_EQ(-1.5e-3, parseFinite("-1.5e-3"));
  EXPECT_EQ(2.0, parseFinite("+2"));
  for (const char* text : {"", " 1", "1 ", "inf", "-nan", "1e999", "0x10", "1,5", "+-1", "++1", "one", "1e"}) {
    EXPECT_FALSE(parseFinite(text)) << text;
  }
}

TEST(ParseFinite, IgnoresTheLocale) {
  setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(1.5, parseFinite("1.5"));
  setlocale(LC_ALL, "C");
}

TEST_F(Files, ReadWhatWasWritten) {
  const std::string path = folder_ / "file";
  const std::string content("with\0zero\n", 10);
  writeFileAtomically(path, content);
  EXPECT_EQ(content, readFile(path));
}

TEST_F(Files, LeaveNothingBehindWhenWritingFails) {
  EXPECT_THROW(writeFileAtomically(folder_ / "absent" / "file", "x"), InputError);
  std::filesystem::create_directory(folder_ / "taken");
  EXPECT_THROW(writeFileAtomically(folder_ / "taken", "x"), InputError);
  int entries = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    entries += entry.exists() ? 1 : 0;
  EXPECT_EQ(1, entries) << "a temporary file is left";
}

TEST_F(Files, AreWrittenWithTheRightsThatTheProcessGivesNewFiles) {
  for (const mode_t mask : {mode_t{022}, mode_t{077}}) {
    const std::string path = folder_ / std::to_string(mask);
    const mode_t before = ::umask(mask);
    writeFileAtomically(path, "x");
    ::umask(before);
    struct stat status {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0666 & ~mask);
  }
}

/// What a process left there that died while it wrote, and had the same number.
TEST_F(Files, LeaveAloneWhatIsInTheTemporaryFilesPlace) {
  const std::string path = folder_ / "file";
  const auto left = [&](int i) { return path + "." + std::to_string(::getpid()) + "-" + std::to_string(i) + ".part"; };
  constexpr int kLeft = 500;
  for (int i = 0; i < kLeft; ++i)
    std::ofstream(left(i)) << "left";
  writeFileAtomically(path, "new");
  EXPECT_EQ(readFile(path), "new");
  for (int i = 0; i < kLeft; ++i)
    EXPECT_EQ(readFile(left(i)), "left");
}

TEST_F(Files, AreWholeWhereManyThreadsWriteTheSameOne) {
  const std::string path = folder_ / "file";
  std::vector<std::thread> threads;
  for (char c = 'a'; c < 'e'; ++c)
    threads.emplace_back([&, c] {
      for (int i = 0; i < 20; ++i)
        writeFileAtomically(path, std::string(10'000, c));
    });
  for (std::thread& one : threads)
    one.join();
  const std::string content = readFile(path);
  EXPECT_EQ(content, std::string(10'000, content.at(0)));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1) << "a temporary file is left";
}

TEST_F(Files, RefuseWhatIsNoRegularFileOrTooLong) {
  EXPECT_THROW(readFile(folder_), InputError);
  EXPECT_THROW(readFile("/dev/zero"), InputError);
  EXPECT_THROW(readFile(folder_ / "absent"), InputError);
  writeFileAtomically(folder_ / "long", std::string(100, 'x'));
  EXPECT_THROW(readFile(folder_ / "long", 99), InputError);
}

TEST(Fingerprint, IsTheKnownHash) {
  EXPECT_EQ("cbf29ce484222325", fingerprint(""));
}

TEST_F(Files, HaveAnotherNameOrNoneWhenSomebodyMovesOrRemovesThem) {
  const std::string path = folder_ / "file", other = folder_ / "other";
  const auto opened = [&] {
    writeFileAtomically(path, "x");
    return ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  };
  int file = opened();
  EXPECT_EQ(fileNameNow(file, path).lost, "");
  std::filesystem::rename(path, other);
  EXPECT_EQ(fileNameNow(file, path).lost, "was moved to " + std::filesystem::canonical(other).string());
  EXPECT_TRUE(fileNameNow(file, path).kept);
  std::filesystem::remove(other);
  EXPECT_EQ(fileNameNow(file, path).lost, "was removed");
  EXPECT_FALSE(fileNameNow(file, path).kept);
  ::close(file);
  file = opened();
  writeFileAtomically(path, "y");
  EXPECT_EQ(fileNameNow(file, path).lost, "was replaced by another file");
  ::close(file);
}

TEST(Printable, ShowsControlCharactersAndLeavesLetters) {
  EXPECT_EQ(printable("a b~"), "a b~");
  EXPECT_EQ(printable("\x1b[2J\n\r\t\x7f"), R"(\x1b[2J\n\r\t\x7f)");
  EXPECT_EQ(printable(std::string_view("\0", 1)), R"(\x00)");
  EXPECT_EQ(printable("a\u00f1o \u20ac \U0001f600"), "a\u00f1o \u20ac \U0001f600");
  EXPECT_EQ(printable("\xc2\x9b"
                      "1m \xff\xc3"),
            R"(\xc2\x9b1m \xff\xc3)")
      << "C1 controls, and what is no UTF-8";
  EXPECT_EQ(printable("\xe0\x80\x9b \xf0\x80\x80\x9b"), R"(\xe0\x80\x9b \xf0\x80\x80\x9b)") << "overlong";
}

TEST(Words, AreReadWithoutAByteOrderMarkAndWithWhatOnlyLooksLikeOne) {
  EXPECT_EQ(withoutMark("\xEF\xBB\xBF"
                        "a"),
            "a");
  EXPECT_EQ(withoutMark("\xEF\xBB\xBF\xEF\xBB\xBF"), "\xEF\xBB\xBF") << "once, at the beginning";
  for (const char* other : {"", "\xEF\xBB", "a\xEF\xBB\xBF", "\xEF\xBB\xBE"})
    EXPECT_EQ(withoutMark(other), other);
}

}  // namespace
}  // namespace knee_robot
