#pragma once

#include "knee_robot/control/machine_state.h"

namespace knee_robot::control {

/// The answers to the last requests, and the requests whose answer the machine has still to find out: several only when
/// they ask for the same. Pure, real-time safe.
class RequestAnswers {
 public:
  using All = std::array<RequestAnswer, SupervisorStatus::kAnswers>;

  void answer(std::uint32_t number, RequestResult result, int axis = 0, double distance_m = 0.0) noexcept;
  /// Request `number` is answered by settle(), too. Where too many wait, the oldest is superseded.
  void await(std::uint32_t number) noexcept;
  bool isAwaiting() const noexcept { return waiting_ != 0; }
  /// Answers all requests that wait.
  void settle(RequestResult result, int axis = 0, double distance_m = 0.0) noexcept;
  /// Nobody waits any more; what was answered stays.
  void dropPending() noexcept { waiting_ = 0; }
  const All& all() const noexcept { return answers_; }

 private:
  All answers_{};
  std::array<std::uint32_t, SupervisorStatus::kAnswers / 2> pending_{};
  std::size_t waiting_ = 0;  // of these
};

}  // namespace knee_robot::control
