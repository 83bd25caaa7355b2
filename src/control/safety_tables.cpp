#include "knee_robot/control/safety_tables.h"

#include "supervisor.h"

namespace knee_robot::control {
namespace {

const char* textOf(ResetRule rule) {
  switch (rule) {
    case ResetRule::OnRequest:
      return "at once";
    case ResetRule::WhenCauseIsGone:
      return "when the cause is gone";
    case ResetRule::Restart:
      return "by a restart only";
  }
  return "?";
}

const char* textOf(StopCategory category, Loop loop) {
  switch (category) {
    case StopCategory::None:
      return "none";
    case StopCategory::Zero:
      return "at once, power is gone (category 0)";
    case StopCategory::ByGuardian:
      return "at once, by the guardian (category 1)";
    case StopCategory::One:
      return loop == Loop::Works ? "along the path (category 1)" : "at once (category 1)";
  }
  return "?";
}

const char* const kRequestNames[kRequestKinds] = {"enable", "disable", "play",      "stop", "emergency stop", "reset",
                                                  "pause",  "resume",  "set speed", "home", "confirm home",   "guide"};

}  // namespace

std::string faultsTable() {
  std::string text = "| number | fault | cause | stop | what to do | reset |\n| --- | --- | --- | --- | --- | --- |\n";
  for (int i = 1; i < kFaults; ++i) {
    const auto fault = static_cast<Fault>(i);
    const FaultDescription& d = describe(fault);
    text += "| " + std::to_string(i) + " | `" + d.name + "` | " + d.sentence + " | " + textOf(d.stop, d.loop) + " | " +
            d.remedy + " | " + textOf(d.reset) + " |\n";
  }
  return text;
}

std::string requestsTable() {
  std::string text = "| state |";
  std::string rule = "| --- |";
  for (const char* name : kRequestNames) {
    text += std::string(" ") + name + " |";
    rule += " --- |";
  }
  text += "\n" + rule + "\n";
  for (int s = 0; s < kMachineStates; ++s) {
    const auto state = static_cast<MachineState>(s);
    text += std::string("| ") + toString(state) + " |";
    for (int r = 0; r < kRequestKinds; ++r)
      text += isPossible(state, static_cast<RequestKind>(r)) ? " yes |" : " - |";
    text += "\n";
  }
  return text;
}

}  // namespace knee_robot::control
