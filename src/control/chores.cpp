#include "chores.h"

#include <pthread.h>

#include <chrono>
#include <exception>
#include <utility>

namespace knee_robot::control {
namespace {

constexpr int kPollsOfStop = 40;  // in a period

void tryTo(const std::function<void()>& chore) noexcept {
  try {
    chore();
  } catch (const std::exception&) {
    // no memory, a folder that is none: this thread must not end the process
  }
}

}  // namespace

Chores::Chores(bool threaded, std::vector<std::function<void()>> chores, double period_s)
    : chores_(std::move(chores)), period_s_(period_s) {
  if (threaded) thread_ = std::thread([this] { loop(); });
}

Chores::~Chores() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void Chores::loop() {
  ::pthread_setname_np(::pthread_self(), "chores");
  for (int poll = 1; !stop_; ++poll) {
    if (poll % kPollsOfStop == 0) {
      for (const std::function<void()>& chore : chores_)
        tryTo(chore);
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(period_s_ / kPollsOfStop));
  }
}

}  // namespace knee_robot::control
