#include "machine_requests.h"

#include "knee_robot/base/numbers.h"
#include "operator_sentences.h"

namespace knee_robot::control {
namespace {

constexpr double kTakenUp_s = 0.5;  // less than anybody waits for an answer

}  // namespace

std::optional<RequestKind> endOf(RequestKind kind) noexcept {
  switch (kind) {
    case RequestKind::Enable:
    case RequestKind::Home:
      return RequestKind::Disable;
    case RequestKind::Play:
    case RequestKind::Resume:
    case RequestKind::Guide:
      return RequestKind::Stop;
    case RequestKind::Disable:
    case RequestKind::Stop:
    case RequestKind::EmergencyStop:
    case RequestKind::Reset:
    case RequestKind::Pause:
    case RequestKind::SetSpeed:
    case RequestKind::ConfirmHome:
      return std::nullopt;
  }
  return RequestKind::Stop;
}

Answer MachineRequests::make(RequestKind kind, double timeout_s, double value) {
  if (!started_) return {false, "the controller does not run"};
  const std::optional<RequestKind> end = endOf(kind);
  if (ending_ && end) return {false, "the controller is ending; nothing moves any more"};
  const auto supervised = [this] { return machine_.supervisor->state() == rt::TaskState::Running; };
  if (!supervised()) return {false, report_.faultSentence()};
  const std::optional<std::uint32_t> number = panel_.send(kind, value, expiry());
  if (!number) return {false, "too many requests at once; try again"};
  RequestAnswer answer;
  const auto is_answered = [&] {
    answer = panel_.supervisor().answers[*number % SupervisorStatus::kAnswers];
    return answer.number == *number || !supervised();
  };
  const bool in_time = runner_.waitUntil(is_answered, timeout_s);
  panel_.forget(*number);
  if (!in_time || answer.number != *number) {
    if (end) askAndForget(*end);
    const std::string why =
        in_time ? "no answer: " + report_.faultSentence()
                : "no answer within " + shortNumber(timeout_s) + " s; the robot is " + toString(report_.state());
    return {false, why + (end ? "; what was asked for is taken back" : "")};
  }
  ControlStatus now;
  report_.fill(now);
  return sentenceOf(kind, answer, now, homing_, machine_.sync->start_tolerance_m);
}

rt::Nanoseconds MachineRequests::expiry() const noexcept {
  return runner_.now() + rt::fromSeconds(kTakenUp_s);
}

void MachineRequests::askAndForget(RequestKind kind) {
  if (const std::optional<std::uint32_t> number = panel_.send(kind, 0.0, expiry())) panel_.forget(*number);
}

}  // namespace knee_robot::control
