#include "own_session.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "signals.h"

namespace knee_robot::nodes {
namespace {

sigset_t handedOn() {
  sigset_t signals;
  ::sigemptyset(&signals);
  for (const int one : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
    ::sigaddset(&signals, one);
  return signals;
}

/// As the other process has ended: with its status, or by its signal.
[[noreturn]] void endLike(int status) {
  if (WIFEXITED(status)) ::_exit(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  std::signal(signal, SIG_DFL);
  sigset_t all;
  ::sigemptyset(&all);
  ::sigprocmask(SIG_SETMASK, &all, nullptr);
  ::raise(signal);
  ::_exit(128 + signal);
}

[[noreturn]] void standFor(pid_t other) {
  sigset_t awaited = handedOn();
  ::sigaddset(&awaited, SIGCHLD);
  while (true) {
    const int signal = ::sigwaitinfo(&awaited, nullptr);
    if (signal > 0 && signal != SIGCHLD) ::kill(other, signal);
    int status = 0;
    if (::waitpid(other, &status, WNOHANG) == other) endLike(status);
  }
}

}  // namespace

void continueInOwnSession(int argc, const char* const* argv) {
  if (std::none_of(argv + 1, argv + argc, [](std::string_view one) { return one == kOwnSession; })) return;
  takeSignals(SIG_DFL);  // and those that nobody expects are ignored, on both sides
  std::signal(SIGCHLD, SIG_DFL);
  sigset_t awaited = handedOn(), before;
  ::sigaddset(&awaited, SIGCHLD);
  ::sigprocmask(SIG_BLOCK, &awaited, &before);  // none is lost between fork and the first wait
  const pid_t starter = ::getpid();
  const pid_t other = ::fork();
  if (other < 0) {
    std::fprintf(stderr, "%s: no process for a session of its own (%s): end others, or raise ulimit -u\n", argv[0],
                 std::strerror(errno));
    ::_exit(1);
  }
  if (other > 0) standFor(other);
  ::setsid();
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != starter) ::_exit(1);  // killed already
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace knee_robot::nodes
