#include "component_watch.h"

#include <algorithm>

namespace knee_robot::control {

bool ComponentWatch::allRun() const noexcept {
  return std::all_of(watched_.begin(), watched_.end(),
                     [](const rt::TaskContext* one) { return one->state() == rt::TaskState::Running; });
}

FaultCause ComponentWatch::firstFailure(bool may_stand) const noexcept {
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const int index = static_cast<int>(i);
    switch (watched_[i]->state()) {
      case rt::TaskState::Running:
        break;
      case rt::TaskState::Exception:
        return {Fault::ComponentException, 0, index};
      case rt::TaskState::FatalError:
        return {Fault::ComponentFatal, 0, index};
      case rt::TaskState::RunTimeError:
      case rt::TaskState::PreOperational:
      case rt::TaskState::Stopped:
        if (!may_stand) return {Fault::ComponentStopped, 0, index};
        break;
    }
  }
  return {};
}

}  // namespace knee_robot::control
