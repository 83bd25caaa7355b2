#include "knee_robot/control/request_answers.h"

namespace knee_robot::control {

void RequestAnswers::answer(std::uint32_t number, RequestResult result, int axis, double distance_m) noexcept {
  answers_[number % answers_.size()] = {number, result, axis, distance_m};
}

void RequestAnswers::settle(RequestResult result, int axis, double distance_m) noexcept {
  if (pending_ != 0) answer(pending_, result, axis, distance_m);
  pending_ = 0;
}

}  // namespace knee_robot::control
