#include "request_answers.h"

#include <algorithm>

namespace knee_robot::control {

void RequestAnswers::answer(std::uint32_t number, RequestResult result, int axis, double distance_m) noexcept {
  RequestAnswer& place = answers_[number % answers_.size()];
  if (static_cast<std::int32_t>(number - place.number) < 0) return;  // nobody waits for it any more, but for that one
  place = {number, result, axis, distance_m};
}

void RequestAnswers::await(std::uint32_t number) noexcept {
  if (waiting_ == pending_.size()) {
    answer(pending_.front(), RequestResult::Superseded);
    std::rotate(pending_.begin(), pending_.begin() + 1, pending_.end());
    --waiting_;
  }
  pending_[waiting_++] = number;
}

void RequestAnswers::settle(RequestResult result, int axis, double distance_m) noexcept {
  for (std::size_t i = 0; i < waiting_; ++i)
    answer(pending_[i], result, axis, distance_m);
  waiting_ = 0;
}

}  // namespace knee_robot::control
