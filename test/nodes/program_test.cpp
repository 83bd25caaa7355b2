#include "src/nodes/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <stdexcept>

#include "knee_robot/base/errors.h"

namespace knee_robot::nodes {
namespace {

struct Outcome {
  int status = 0;
  std::string out, error;
};

Outcome runWith(std::vector<const char*> arguments, const std::function<int()>& body) {
  CommandLine app("does something", "thing");
  int number = 0;
  app.option("--number", number, "how many").required();
  arguments.insert(arguments.begin(), "thing");
  Outcome outcome;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  outcome.status = runProgram(app, static_cast<int>(arguments.size()), arguments.data(), body);
  outcome.out = ::testing::internal::GetCapturedStdout();
  outcome.error = ::testing::internal::GetCapturedStderr();
  return outcome;
}

/// In a process of its own, which has `soft` and `hard`.
bool isLimitedTo(rlim_t expected, rlim_t soft, rlim_t hard) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit given{soft, hard};
    rlimit found{};
    const bool set = ::setrlimit(RLIMIT_NOFILE, &given) == 0;
    limitDescriptors();
    ::getrlimit(RLIMIT_NOFILE, &found);
    ::_exit(set && found.rlim_cur == expected && found.rlim_max == expected ? 0 : 1);
  }
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Descriptors, AreAsManyAsAllowedAndNotMoreThanTheRosLibraryCanSearch) {
  EXPECT_TRUE(isLimitedTo(1000, 256, 1000));
  EXPECT_TRUE(isLimitedTo(4096, 1024, 5000));
}

TEST(RunProgram, ReturnsWhatTheBodyReturns) {
  const Outcome o = runWith({"--number", "1"}, [] { return 0; });
  EXPECT_EQ(o.status, 0);
  EXPECT_EQ(o.error, "");
}

TEST(RunProgram, MapsFailuresToStatusesAndOneLine) {
  const Outcome input = runWith({"--number", "1"}, []() -> int { throw InputError("file.csv:3: bad\nvalue"); });
  EXPECT_EQ(input.status, 2);
  EXPECT_EQ(input.error, "thing: file.csv:3: bad value\n");
  EXPECT_EQ(runWith({"--number", "1"}, []() -> int { throw Refusal("too short"); }).status, 3);
  const Outcome other = runWith({"--number", "1"}, []() -> int { throw std::out_of_range("vector"); });
  EXPECT_EQ(other.status, 1);
  EXPECT_EQ(other.error, "thing: unexpected failure: vector\n");
}

TEST(RunProgram, PrintsIntoNoFileThatGotTheNumberOfAClosedStream) {
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(STDOUT_FILENO);
    ::close(STDERR_FILENO);
    openStandardStreams();
    const int next = ::open("/dev/null", O_RDWR);
    ::_exit(next > STDERR_FILENO ? 0 : 1);
  }
  int status = -1;
  ::waitpid(process, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(RunProgram, RefusesABadCommandLineWithOneLineAndStatusTwo) {
  for (const std::vector<const char*>& arguments : {std::vector<const char*>{},
                                                    {"--number"},
                                                    {"--number", "x"},
                                                    {"--number", "1", "--what"},
                                                    {"--number", "1", "extra"}}) {
    const Outcome o = runWith(arguments, [] { return 0; });
    EXPECT_EQ(o.status, 2);
    EXPECT_EQ(std::count(o.error.begin(), o.error.end(), '\n'), 1) << o.error;
  }
}

TEST(RunProgram, ShowsHelp) {
  const Outcome o = runWith({"--help"}, [] { return 5; });
  EXPECT_EQ(o.status, 0);
  EXPECT_NE(o.out.find("does something"), std::string::npos);
}

/// Exit status of a program that prints where nothing can be written.
int statusOnFullDisk(bool serves, bool stream) {
  const pid_t process = ::fork();
  if (process == 0) {
    const int full = ::open("/dev/full", O_WRONLY);
    ::dup2(full, STDOUT_FILENO);
    CommandLine app("does something", "thing");
    if (serves) app.serves();
    const char* const arguments[] = {"thing"};
    ::_exit(runProgram(app, 1, arguments, [&] {
      stream ? void(std::cout << "a result") : void(std::printf("a result"));
      return 0;
    }));
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  return WEXITSTATUS(status);
}

TEST(RunProgram, FailsWhenItsOutputIsLost) {
  EXPECT_EQ(statusOnFullDisk(false, true), 1);
  EXPECT_EQ(statusOnFullDisk(false, false), 1);
}

TEST(RunProgram, ThatServesHasNotFailedWhenItsTerminalIsGone) {
  EXPECT_EQ(statusOnFullDisk(true, true), 0);
  EXPECT_EQ(statusOnFullDisk(true, false), 0);
}

TEST(CommandLineText, IsReadBackByAShell) {
  const char* const arguments[] = {"identify", "--train", "my run's file.csv", "$HOME", "a;b", "", "x=1"};
  const std::string line = commandLine("identify", 7, arguments);
  EXPECT_EQ(line, "rosrun knee_robot identify --train 'my run'\\''s file.csv' '$HOME' 'a;b' '' x=1");
}

}  // namespace
}  // namespace knee_robot::nodes
