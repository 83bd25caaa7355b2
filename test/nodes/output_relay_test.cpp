// A process whose output nobody reads goes on; what it says arrives where somebody does, up to its last words.
#include "src/nodes/output_relay.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

namespace knee_robot::nodes {
namespace {

/// A process of its own that says what `speak` says into a pipe.
class Speaker {
 public:
  explicit Speaker(const std::function<void()>& speak) {
    EXPECT_EQ(::pipe(pipe_.data()), 0);
    std::fflush(nullptr);
    process_ = ::fork();
    if (process_ != 0) {
      ::close(pipe_[1]);
      return;
    }
    ::alarm(30);  // one that waits for ever is a failure, not a hung test
    ::dup2(pipe_[1], STDOUT_FILENO);
    ::dup2(pipe_[1], STDERR_FILENO);
    ::close(pipe_[0]);
    ::close(pipe_[1]);
    speak();
    ::_exit(0);
  }
  ~Speaker() { ::close(pipe_[0]); }
  /// Without reading a byte. Status as waitpid gives it.
  int end() const {
    int status = -1;
    ::waitpid(process_, &status, 0);
    return status;
  }
  std::string heard() const {
    std::string text;
    std::array<char, 4096> some{};
    for (ssize_t got = 1; got > 0; text.append(some.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))))
      got = ::read(pipe_[0], some.data(), some.size());
    return text;
  }

 private:
  std::array<int, 2> pipe_{};
  pid_t process_ = -1;
};

TEST(OutputRelayTest, AProcessWhoseOutputNobodyReadsGoesOnAndEnds) {
  const Speaker speaker([] {
    const OutputRelay relay;
    const std::string line(100, 'x');
    for (int i = 0; i < 40000; ++i)  // 4 MB, more than any pipe takes
      std::fprintf(i % 2 == 0 ? stdout : stderr, "%s\n", line.c_str());
  });
  EXPECT_EQ(speaker.end(), 0);
}

TEST(OutputRelayTest, WhatIsSaidArrivesWholeWhereSomebodyReads) {
  const Speaker speaker([] {
    const OutputRelay relay;
    std::printf("ready\n");
    std::fprintf(stderr, "careful\n");
  });
  const std::string heard = speaker.heard();
  EXPECT_NE(heard.find("ready\n"), std::string::npos) << heard;
  EXPECT_NE(heard.find("careful\n"), std::string::npos) << heard;
  EXPECT_EQ(speaker.end(), 0);
}

TEST(OutputRelayTest, AProcessThatIsSentAnAbortDiesOfIt) {
  const Speaker speaker([] {
    const OutputRelay relay;
    ::kill(::getpid(), SIGABRT);
  });
  const int status = speaker.end();
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) << status;
}

TEST(OutputRelayTest, TheLastWordsOfAProcessThatAbortsAreHeard) {
  const Speaker speaker([] {
    const OutputRelay relay;
    std::fprintf(stderr, "this is why\n");
    std::abort();
  });
  EXPECT_EQ(speaker.heard(), "this is why\n");
  EXPECT_TRUE(WIFSIGNALED(speaker.end()));
}

TEST(OutputRelayTest, SaysTheSameAfterwardsAsBefore) {
  const Speaker speaker([] {
    { const OutputRelay relay; }
    std::fprintf(stderr, "still here\n");
  });
  EXPECT_EQ(speaker.heard(), "still here\n");
}

}  // namespace
}  // namespace knee_robot::nodes
