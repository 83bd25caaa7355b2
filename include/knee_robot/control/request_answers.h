#pragma once

#include "knee_robot/control/machine_state.h"

namespace knee_robot::control {

/// The answers to the last requests, and the one request whose answer the machine has still to find out. Pure, real-time safe.
class RequestAnswers {
 public:
  using All = std::array<RequestAnswer, SupervisorStatus::kAnswers>;

  void answer(std::uint32_t number, RequestResult result, int axis = 0, double distance_m = 0.0) noexcept;
  /// Request `number` is answered by settle().
  void await(std::uint32_t number) noexcept { pending_ = number; }
  bool isAwaiting() const noexcept { return pending_ != 0; }
  /// Answers the request that waits, if any.
  void settle(RequestResult result, int axis = 0, double distance_m = 0.0) noexcept;
  /// Nobody waits any more; what was answered stays.
  void dropPending() noexcept { pending_ = 0; }
  const All& all() const noexcept { return answers_; }

 private:
  All answers_{};
  std::uint32_t pending_ = 0;  // 0: none
};

}  // namespace knee_robot::control
