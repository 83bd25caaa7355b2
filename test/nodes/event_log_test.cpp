// The event log's file: bounded, whole lines, and honest about a disk that refuses.
#include "../../src/nodes/event_log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "../../src/nodes/controller_events.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::nodes {
namespace {

namespace fs = std::filesystem;

class EventLogTest : public testing::Test {
 protected:
  EventLogTest() { path_ = folder_ + "/events/controller.jsonl"; }

  static std::vector<nlohmann::json> entries(const std::string& path) {
    std::vector<nlohmann::json> all;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);)
      all.push_back(nlohmann::json::parse(line));  // throws on half a line
    return all;
  }
  /// Waits until the log says so; the test ends by its own time limit otherwise.
  static void waitFor(const std::function<bool()>& true_at_last) {
    while (!true_at_last())
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const TemporaryFolder folder_;
  std::string path_;
};

TEST_F(EventLogTest, WritesEveryEntryAsALineThatNobodysWordsCanForge) {
  {
    EventLog log(path_);
    log.request("/somebody", "load_reference a\"b\n{\"number\": 9}", {false, "no \x80 such file\r\n"});
    log.add("state", "", "holding");
  }
  const auto lines = entries(path_);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["kind"], "refused");
  EXPECT_EQ(lines[0]["who"], "/somebody");
  EXPECT_EQ(lines[0]["what"], "load_reference a\"b\n{\"number\": 9}");
  EXPECT_EQ(lines[1]["number"], 2);
  EXPECT_GT(lines[1]["time"].get<double>(), 1.7e9);
}

TEST_F(EventLogTest, KeepsTheNewestInMemoryAndAllOfThemInBoundedFiles) {
  {
    EventLog log(path_, 20'000, 3);
    for (int i = 0; i < 1500; ++i) {
      log.add("state", "", "state number " + std::to_string(i));
      if (i % 50 == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));  // so that the writer writes in between
    }
    EXPECT_EQ(log.after(0).size(), EventLog::kRemembered);
    EXPECT_EQ(log.after(1490).size(), 10u);
    EXPECT_EQ(log.after(1490).front().number, 1491u);
  }
  std::size_t bytes = 0;
  int files = 0;
  for (const auto& one : fs::directory_iterator(folder_ + "/events")) {
    bytes += fs::file_size(one);
    ++files;
    EXPECT_FALSE(entries(one.path()).empty());
  }
  EXPECT_LE(files, 4);
  EXPECT_GT(files, 1);
  EXPECT_EQ(entries(path_).back()["number"], 1500);
}

TEST_F(EventLogTest, SaysThatTheDiskRefusesAndWritesWhatWaitedWhenItTakesItAgain) {
  fs::create_directories(folder_ + "/events");
  fs::create_symlink("/dev/full", path_);
  std::vector<std::string> heard;
  {
    EventLog log(path_);
    log.setListener([&](const LoggedEvent& event) { heard.push_back(event.kind + ": " + event.what); });
    log.add("state", "", "holding");
    waitFor([&] { return !log.refusal().empty(); });
    EXPECT_NE(log.refusal().find("No space left on device"), std::string::npos) << log.refusal();
    log.add("state", "", "playing");
    EXPECT_EQ(log.after(0).back().what, "playing") << "memory and topic go on";
    fs::remove(path_);
    waitFor([&] { return log.refusal().empty(); });
    log.setListener({});
  }
  const auto lines = entries(path_);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0]["what"], "holding");
  EXPECT_EQ(lines[1]["kind"], "log");
  EXPECT_EQ(lines[2]["what"], "playing");
  EXPECT_NE(lines[3]["what"].get<std::string>().find("written again"), std::string::npos);
  ASSERT_EQ(heard.size(), 4u);
  EXPECT_NE(heard[1].find("entries wait in memory"), std::string::npos) << heard[1];
}

TEST_F(EventLogTest, SaysHowManyEntriesADiskThatWasFullForLongHasCost) {
  fs::create_directories(folder_ + "/events");
  fs::create_symlink("/dev/full", path_);
  {
    EventLog log(path_);
    for (std::size_t i = 0; i < EventLog::kWaiting + 100; ++i)
      log.add("state", "", "holding");
    waitFor([&] { return !log.refusal().empty(); });
    fs::remove(path_);
    waitFor([&] { return log.refusal().empty(); });
  }
  const auto lines = entries(path_);
  EXPECT_EQ(lines.size(), EventLog::kWaiting + 1);
  EXPECT_EQ(lines.back()["answer"], "101 entries are missing in it") << "the one that said that the disk refuses, too";
}

/// A pipe that nobody reads is a disk that takes its time: one append is under way until the reader begins.
TEST_F(EventLogTest, SaysHowManyEntriesASlowDiskHasCostWithoutEverRefusing) {
  fs::create_directories(folder_ + "/events");
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  const int pipe = ::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(pipe, 0);
  ASSERT_GE(::fcntl(pipe, F_SETPIPE_SZ, 4096), 4096);
  std::string written;
  std::atomic<bool> ended{false};
  const auto take = [&] {
    char piece[4096];
    const ssize_t got = ::read(pipe, piece, sizeof piece);
    if (got > 0) written.append(piece, static_cast<std::size_t>(got));
    return got > 0;
  };
  std::thread reader;
  {
    EventLog log(path_);
    const std::string longest(2000, 'x');
    log.add(longest, longest, longest, longest);
    waitFor([&] {
      int bytes = 0;
      return ::ioctl(pipe, FIONREAD, &bytes) == 0 && bytes > 0;
    });
    for (std::size_t i = 0; i < 2 * EventLog::kWaiting + 100; ++i)
      log.add("state", "", "holding");
    EXPECT_EQ(log.refusal(), "");
    reader = std::thread([&] {
      while (take() || !ended)
        std::this_thread::yield();
    });
  }
  ended = true;
  reader.join();
  while (take()) {
  }
  ::close(pipe);
  std::ofstream(folder_ + "/taken") << written;
  const auto lines = entries(folder_ + "/taken");
  ASSERT_EQ(lines.size(), 1 + EventLog::kWaiting);
  EXPECT_EQ(lines.front()["number"], 1);
  EXPECT_NE(lines.back()["what"].get<std::string>().find("the disk was too slow"), std::string::npos) << lines.back();
  EXPECT_EQ(lines.back()["answer"], std::to_string(EventLog::kWaiting + 101) + " entries are missing in it");
  EXPECT_EQ(lines.back()["number"], 2 * EventLog::kWaiting + 102);
}

TEST_F(EventLogTest, LeavesNoHalfLineWhereTheDiskFillsInTheMiddleOfOne) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);  // write() takes a part, then refuses
  {
    EventFile file(path_, 1'000'000, 3);
    int taken = 0;
    std::string reason;
    for (; reason.empty(); ++taken)
      reason = file.append("{\"text\": \"" + std::string(120, 'x') + "\"}\n");
    EXPECT_NE(reason.find("File too large"), std::string::npos) << reason;
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(entries(path_).size(), static_cast<std::size_t>(taken - 1));
    EXPECT_EQ(file.append("{}\n"), "");
  }
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(entries(path_).back(), nlohmann::json::object());
}

TEST_F(EventLogTest, BeginsOnALineOfItsOwnAfterAProcessThatDiedInTheMiddleOfOne) {
  fs::create_directories(folder_ + "/events");
  std::ofstream(path_) << "{\"number\": 1}\n{\"numb";
  { EventLog(path_).add("state", "", "holding"); }
  const std::string content = readFile(path_);
  EXPECT_NE(content.find("{\"numb\n{\"number\":1,"), std::string::npos) << content;
}

/// As logrotate does it, and whoever tidies up.
TEST_F(EventLogTest, BeginsANewFileAndSaysSoWhereSomebodyHasTakenTheOldOneAway) {
  const std::string old = folder_ + "/events/of_yesterday";
  const auto numberIn = [&](const std::string& path) {
    return fs::exists(path) && !entries(path).empty() ? entries(path).back()["number"].get<int>() : 0;
  };
  {
    EventLog log(path_);
    log.add("state", "", "holding");
    waitFor([&] { return numberIn(path_) == 1; });
    fs::rename(path_, old);
    waitFor([&] { return numberIn(path_) == 2; });  // though nothing else happens
    fs::remove_all(folder_ + "/events");
    waitFor([&] { return numberIn(path_) == 3; });
    log.add("state", "", "playing");
  }
  const auto lines = entries(path_);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["kind"], "log");
  EXPECT_NE(lines[0]["what"].get<std::string>().find(path_ + ": was removed"), std::string::npos) << lines[0];
  EXPECT_EQ(lines[1]["what"], "playing");
}

TEST_F(EventLogTest, SaysWhereTheOldFileIs) {
  const std::string old = folder_ + "/events/of_yesterday";
  {
    EventLog log(path_);
    log.add("state", "", "holding");
    waitFor([&] { return fs::exists(path_) && !entries(path_).empty(); });
    fs::rename(path_, old);
    waitFor([&] { return fs::exists(path_) && !entries(path_).empty(); });
  }
  EXPECT_EQ(entries(old).back()["what"], "holding");
  const std::string said = entries(path_).front()["what"];
  EXPECT_NE(said.find("was moved to " + fs::canonical(old).string()), std::string::npos) << said;
}

TEST_F(EventLogTest, SaysThatSomebodyHasCutItShort) {
  {
    EventLog log(path_);
    log.add("state", "", "holding");
    waitFor([&] { return fs::exists(path_) && !entries(path_).empty(); });
    fs::resize_file(path_, 0);
    waitFor([&] { return !entries(path_).empty(); });
  }
  EXPECT_NE(entries(path_).front()["what"].get<std::string>().find("was cut short"), std::string::npos);
}

TEST(CallerOfAGoal, IsTheNodesNameInItsId) {
  EXPECT_EQ(callerOfGoal("/operator_page-3-1795340000.123"), "/operator_page");
  EXPECT_EQ(callerOfGoal("/my-node-12-17.5"), "/my-node");
  EXPECT_EQ(callerOfGoal("anything"), "anything");
  EXPECT_EQ(callerOfGoal(""), "");
  EXPECT_EQ(callerOfGoal("-"), "-");
}

}  // namespace
}  // namespace knee_robot::nodes
