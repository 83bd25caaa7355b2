#pragma once

#include <csignal>

namespace knee_robot::nodes {

/// For the processes that drives depend on. INT, TERM, HUP and QUIT ask them to end, in order, through `stop`. All other
/// signals that end or stop a process by default and that are no sign of a broken one are ignored: of terminals and
/// pipes, of timers and limits, and those that somebody sends to the wrong process.
inline void takeSignals(void (*stop)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
    std::signal(signal, stop);
  for (const int signal : {SIGPIPE, SIGTSTP, SIGTTIN, SIGTTOU, SIGXFSZ, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM,
                           SIGPROF, SIGIO, SIGPWR})
    std::signal(signal, SIG_IGN);
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal)
    std::signal(signal, SIG_IGN);
}

}  // namespace knee_robot::nodes
