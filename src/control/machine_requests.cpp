#include "machine_requests.h"

#include "knee_robot/base/numbers.h"
#include "operator_sentences.h"

namespace knee_robot::control {
namespace {

bool mayMove(RequestKind kind) {
  switch (kind) {
    case RequestKind::Enable:
    case RequestKind::Play:
    case RequestKind::Resume:
    case RequestKind::Home:
    case RequestKind::Guide:
      return true;
    case RequestKind::Disable:
    case RequestKind::Stop:
    case RequestKind::EmergencyStop:
    case RequestKind::Reset:
    case RequestKind::Pause:
    case RequestKind::SetSpeed:
    case RequestKind::ConfirmHome:
      return false;
  }
  return true;
}

}  // namespace

Answer MachineRequests::make(RequestKind kind, double timeout_s, double value) {
  if (!started_) return {false, "the controller does not run"};
  if (ending_ && mayMove(kind)) return {false, "the controller is ending; nothing moves any more"};
  const auto supervised = [this] { return machine_.supervisor->state() == rt::TaskState::Running; };
  if (!supervised()) return {false, report_.faultSentence()};
  const std::optional<std::uint32_t> number = panel_.send(kind, value);
  if (!number) return {false, "too many requests at once; try again"};
  RequestAnswer answer;
  const auto is_answered = [&] {
    answer = panel_.supervisor().answers[*number % SupervisorStatus::kAnswers];
    return answer.number == *number || !supervised();
  };
  const bool in_time = runner_.waitUntil(is_answered, timeout_s);
  panel_.forget(*number);
  if (!in_time || answer.number != *number) {
    return {false, "no answer within " + shortNumber(timeout_s) + " s; the robot is " + toString(report_.state())};
  }
  ControlStatus now;
  report_.fill(now);
  return sentenceOf(answer, now, homing_, machine_.sync->start_tolerance_m);
}

}  // namespace knee_robot::control
