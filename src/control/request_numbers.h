#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "knee_robot/control/machine_state.h"

namespace knee_robot::control {

/// Numbers for requests. The answer to request n stands at n modulo SupervisorStatus::kAnswers until the next one comes
/// there: no number is given out whose place somebody still looks at, however often others ask meanwhile. Not for
/// several threads at once.
class RequestNumbers {
 public:
  /// The next number; nothing while every place is looked at.
  std::optional<std::uint32_t> take() noexcept {
    for (std::size_t tried = 0; tried < taken_.size(); ++tried) {
      if (++last_ == 0) ++last_;  // 0 is no request
      if (taken_[last_ % taken_.size()]) continue;
      taken_[last_ % taken_.size()] = true;
      return last_;
    }
    return std::nullopt;
  }
  /// Nobody looks for the answer any more.
  void giveBack(std::uint32_t number) noexcept { taken_[number % taken_.size()] = false; }

 private:
  std::array<bool, SupervisorStatus::kAnswers> taken_{};
  std::uint32_t last_ = 0;
};

}  // namespace knee_robot::control
