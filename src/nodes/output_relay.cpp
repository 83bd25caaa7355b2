#include "output_relay.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <string_view>
#include <thread>

namespace knee_robot::nodes {
namespace {

constexpr int kRoom = 1 << 20;  // bytes, what every user may have
constexpr auto kRelayPatience = std::chrono::seconds(1);

std::array<std::atomic<int>, 2> relayed = {{{-1}, {-1}}};  // what is to be read of stdout and of stderr

bool mayBlock(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return false;
  return S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode) || ::isatty(descriptor) != 0;
}

int waiting(int descriptor) {
  int bytes = 0;
  return descriptor >= 0 && ::ioctl(descriptor, FIONREAD, &bytes) == 0 ? bytes : 0;
}

/// Why the process aborts is told by what it wrote last. It dies of the signal then, whoever sent it: abort() sees to
/// that by itself, a watchdog's signal would be lost.
void handOnTheLastWords(int) {
  constexpr timespec kPause{0, 5'000'000};
  bool all_read = false;
  for (int i = 0; i < 20 && !all_read; ++i) {
    all_read = waiting(relayed[0].load()) + waiting(relayed[1].load()) == 0;
    ::nanosleep(&kPause, nullptr);
  }
  std::signal(SIGABRT, SIG_DFL);
  std::raise(SIGABRT);
}

}  // namespace

/// One of the two. The thread that hands on holds a share of it: it may be left behind with a reader that never comes
/// back.
class OutputRelay::Stream : public std::enable_shared_from_this<Stream> {
 public:
  explicit Stream(int descriptor) : descriptor_(descriptor) {
    if (!mayBlock(descriptor) || ::pipe2(pipe_.data(), O_CLOEXEC) != 0) return;
    ::fcntl(pipe_[1], F_SETPIPE_SZ, kRoom);
    ::fcntl(pipe_[1], F_SETFL, O_NONBLOCK);
    original_ = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 3);
    if (original_ < 0 || ::dup2(pipe_[1], descriptor) < 0) original_ = -1;
    ::close(pipe_[1]);
  }
  void begin() {
    if (original_ < 0) return;
    relayed[static_cast<std::size_t>(descriptor_ - STDOUT_FILENO)] = pipe_[0];
    std::thread([self = shared_from_this()] { self->handOn(); }).detach();
  }
  /// The original takes its place again; the pipe has no writer any more, and the thread ends when it has handed on the
  /// rest.
  void end() {
    if (original_ < 0) return;
    relayed[static_cast<std::size_t>(descriptor_ - STDOUT_FILENO)] = -1;
    ::dup2(original_, descriptor_);
    const auto give_up = std::chrono::steady_clock::now() + kRelayPatience;
    while (!ended_ && std::chrono::steady_clock::now() < give_up)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

 private:
  void handOn() {
    std::array<char, 65536> text{};
    for (ssize_t got = 1; got > 0;) {
      got = ::read(pipe_[0], text.data(), text.size());
      if (got > 0) write({text.data(), static_cast<std::size_t>(got)});
      if (got < 0 && errno == EINTR) got = 1;
    }
    ended_ = true;
  }
  /// What cannot be written, because nobody reads any more, is lost.
  void write(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t put = ::write(original_, text.data(), text.size());
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) return;
      text.remove_prefix(static_cast<std::size_t>(put));
    }
  }

  const int descriptor_;
  int original_ = -1;
  std::array<int, 2> pipe_ = {-1, -1};
  std::atomic<bool> ended_{false};
};

OutputRelay::OutputRelay() {
  std::fflush(stdout);
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    streams_.push_back(std::make_shared<Stream>(descriptor));
    streams_.back()->begin();
  }
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  std::signal(SIGABRT, handOnTheLastWords);
}

OutputRelay::~OutputRelay() {
  std::signal(SIGABRT, SIG_DFL);
  std::fflush(stdout);
  for (const auto& stream : streams_)
    stream->end();
}

}  // namespace knee_robot::nodes
