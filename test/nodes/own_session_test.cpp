// What was started by roslaunch, which signals and kills the process group of its node, and must not be killed with it.
#include "src/nodes/own_session.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <functional>
#include <string>

namespace knee_robot::nodes {
namespace {

volatile std::sig_atomic_t told = 0;

/// A node in a process group of its own, as roslaunch starts it; what it does after continueInOwnSession is `work`,
/// which may say something through the descriptor that it is given.
class Node {
 public:
  Node(const char* argument, const std::function<int(int)>& work) {
    EXPECT_EQ(::pipe(pipe_.data()), 0);
    group_ = ::fork();
    if (group_ != 0) {
      ::close(pipe_[1]);
      return;
    }
    ::setpgid(0, 0);
    ::close(pipe_[0]);
    std::array<const char*, 2> arguments{"node", argument};
    continueInOwnSession(2, arguments.data());
    ::alarm(30);  // one that waits for ever is a failure, not a hung test
    std::signal(SIGTERM, [](int number) { told = number; });
    std::signal(SIGINT, [](int number) { told = number; });
    ::_exit(work(pipe_[1]));
  }
  ~Node() { ::close(pipe_[0]); }

  void signalGroup(int number) const { EXPECT_EQ(::kill(-group_, number), 0); }
  int end() const {
    int status = -1;
    ::waitpid(group_, &status, 0);
    return status;
  }
  /// The next byte that it says; '-': it is gone.
  char hear() const {
    char byte = '-';
    return ::read(pipe_[0], &byte, 1) == 1 ? byte : '-';
  }

 private:
  std::array<int, 2> pipe_{};
  pid_t group_ = -1;
};

void say(int pipe, char byte) {
  if (::write(pipe, &byte, 1) != 1) ::_exit(1);
}

void awaitOrder() {
  while (told == 0)
    ::usleep(1000);
}

int saysReadyAndWhatItIsTold(int pipe) {
  say(pipe, 'r');
  awaitOrder();
  say(pipe, told == SIGTERM ? 't' : 'i');
  ::usleep(100'000);  // it carries a load for longer than whoever started it has patience
  say(pipe, 'e');
  return 5;
}

TEST(OwnSession, OutlivesTheKillingOfItsGroupAndIsToldToEnd) {
  const Node node(kOwnSession, saysReadyAndWhatItIsTold);
  ASSERT_EQ(node.hear(), 'r');
  node.signalGroup(SIGKILL);
  EXPECT_EQ(WTERMSIG(node.end()), SIGKILL);
  EXPECT_EQ(node.hear(), 't');
  EXPECT_EQ(node.hear(), 'e') << "killed with its group";
}

TEST(OwnSession, IsHandedWhatItsGroupIsToldAndEndsWithItsOwnStatus) {
  const Node node(kOwnSession, saysReadyAndWhatItIsTold);
  ASSERT_EQ(node.hear(), 'r');
  node.signalGroup(SIGINT);
  EXPECT_EQ(node.hear(), 'i');
  EXPECT_EQ(WEXITSTATUS(node.end()), 5) << "roslaunch must not think that it has ended before it has";
}

TEST(OwnSession, IsSaidToHaveDiedAsItDied) {
  const Node node(kOwnSession, [](int) { return ::raise(SIGKILL); });
  const int status = node.end();
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
}

TEST(OwnSession, IsLeftToWhoeverAsksForIt) {
  const Node node("--other", [](int pipe) {
    say(pipe, ::getpgid(0) == ::getpid() && ::getsid(0) != ::getpid() ? 'g' : 's');
    return 0;
  });
  EXPECT_EQ(node.hear(), 'g');
}

}  // namespace
}  // namespace knee_robot::nodes
