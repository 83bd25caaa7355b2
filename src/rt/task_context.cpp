#include "knee_robot/rt/task_context.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <utility>

#include "knee_robot/base/errors.h"
#include "knee_robot/rt/operation.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::rt {
namespace {

constexpr Nanoseconds kCommandTimeout = kNanosecondsPerSecond;

template <typename Named>
Named* find(const std::vector<Named*>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named* one) { return one->name() == name; });
  return found == all.end() ? nullptr : *found;
}

}  // namespace

const char* toString(TaskState state) noexcept {
  switch (state) {
    case TaskState::PreOperational:
      return "PreOperational";
    case TaskState::Stopped:
      return "Stopped";
    case TaskState::Running:
      return "Running";
    case TaskState::RunTimeError:
      return "RunTimeError";
    case TaskState::Exception:
      return "Exception";
    case TaskState::FatalError:
      return "FatalError";
  }
  return "?";
}

TaskContext::TaskContext(std::string name) : name_(std::move(name)) {}
TaskContext::~TaskContext() = default;

bool TaskContext::configure() {
  return perform(Command::Configure);
}
bool TaskContext::start() {
  return perform(Command::Start);
}
bool TaskContext::stop() {
  return perform(Command::Stop);
}
bool TaskContext::recover() {
  return perform(Command::Recover);
}

bool TaskContext::perform(Command command) {
  const Executor* executor = executor_.load(std::memory_order_acquire);
  if (executor == nullptr || !executor->mustHandOver()) return execute(command);
  return mailbox_.call(command, kCommandTimeout) == CommandMailbox::Answer::Accepted;
}

bool TaskContext::execute(Command command) noexcept {
  switch (command) {
    case Command::Configure:
      return doConfigure();
    case Command::Start:
      return doStart();
    case Command::Stop:
      return doStop();
    case Command::Recover:
      return doRecover();
  }
  return false;
}

void TaskContext::update(const Cycle& cycle) noexcept {
  mailbox_.serve([this](Command command) { return execute(command); });
  if (state() != TaskState::Running) return;
  active_hook_ = Hook::Update;
  if (!guarded([&] { updateHook(cycle); })) enterException(Hook::Update);
  active_hook_ = Hook::None;
}

/// False when `call` threw; the sentence is kept.
template <typename Call>
bool TaskContext::guarded(Call&& call) noexcept {
  try {
    call();
    return true;
  } catch (const std::exception& error) {
    refuse(error.what());
  } catch (...) {
    refuse("an exception of unknown type");
  }
  return false;
}

bool TaskContext::doConfigure() noexcept {
  if (state() != TaskState::PreOperational && state() != TaskState::Stopped) {
    return refuseCommand("configure is possible only in PreOperational and Stopped");
  }
  bool accepted = false;
  active_hook_ = Hook::Configure;
  if (!guarded([&] { accepted = configureHook(); })) {
    enterException(Hook::Configure);
  } else if (state() <= TaskState::Stopped) {  // the hook may have called fatal() or exception()
    state_.store(accepted ? TaskState::Stopped : TaskState::PreOperational, std::memory_order_release);
  }
  active_hook_ = Hook::None;
  return state() == TaskState::Stopped;
}

bool TaskContext::doStart() noexcept {
  if (state() != TaskState::Stopped) return refuseCommand("start is possible only in Stopped");
  bool accepted = false;
  active_hook_ = Hook::Start;
  if (!guarded([&] { accepted = startHook(); })) {
    enterException(Hook::Start);
  } else if (accepted && state() == TaskState::Stopped) {
    state_.store(TaskState::Running, std::memory_order_release);
  }
  active_hook_ = Hook::None;
  return state() == TaskState::Running;
}

bool TaskContext::doStop() noexcept {
  if (!isRunning()) return refuseCommand("stop is possible only in Running and RunTimeError");
  active_hook_ = Hook::Stop;
  if (!guarded([&] { stopHook(); })) {
    enterException(Hook::Stop);
  } else if (isRunning()) {
    state_.store(TaskState::Stopped, std::memory_order_release);
  }
  active_hook_ = Hook::None;
  return state() == TaskState::Stopped;
}

bool TaskContext::doRecover() noexcept {
  if (state() == TaskState::RunTimeError) {
    state_.store(TaskState::Running, std::memory_order_release);
    return true;
  }
  if (state() == TaskState::Exception) {
    state_.store(TaskState::PreOperational, std::memory_order_release);
    return true;
  }
  return refuseCommand("recover is possible only in RunTimeError and Exception");
}

void TaskContext::error() noexcept {
  if (state() == TaskState::Running) state_.store(TaskState::RunTimeError, std::memory_order_release);
}

void TaskContext::exception(const char* sentence) noexcept {
  refuse(sentence);
  enterException(active_hook_);
}

/// stopHook is called unless it was the one that threw, or the component was not running. An exception from it on this
/// way is a fatal error.
void TaskContext::enterException(Hook thrown_by) noexcept {
  if (state() >= TaskState::Exception) return;
  const bool was_running = isRunning() || thrown_by == Hook::Start;
  state_.store(TaskState::Exception, std::memory_order_release);  // first, so that others react at once
  std::array<char, 256> cause = refusal_;
  if (was_running && thrown_by != Hook::Stop && !guarded([&] { stopHook(); })) enterFatal(false);
  refusal_ = cause;
}

void TaskContext::fatal(const char* sentence) noexcept {
  refuse(sentence);
  enterFatal(active_hook_ != Hook::Stop);
}

void TaskContext::enterFatal(bool run_stop_hook) noexcept {
  const TaskState before = state_.exchange(TaskState::FatalError, std::memory_order_acq_rel);
  if (before == TaskState::FatalError) return;
  const bool was_running =
      before == TaskState::Running || before == TaskState::RunTimeError || active_hook_ == Hook::Start;
  std::array<char, 256> cause = refusal_;
  if (run_stop_hook && was_running) guarded([&] { stopHook(); });
  refusal_ = cause;
}

bool TaskContext::refuse(const char* sentence) noexcept {
  std::strncpy(refusal_.data(), sentence, refusal_.size() - 1);
  return false;
}

/// A command in the wrong state; the cause of an exception stays readable.
bool TaskContext::refuseCommand(const char* sentence) noexcept {
  return state() >= TaskState::Exception ? false : refuse(sentence);
}

void TaskContext::addPort(PortBase& port) {
  if (this->port(port.name()) != nullptr) {
    throw InputError("component " + name_ + " has two ports named " + port.name() + "; rename one");
  }
  ports_.push_back(&port);
}

void TaskContext::addProperty(PropertyBase& property) {
  if (this->property(property.name()) != nullptr) {
    throw InputError("component " + name_ + " has two properties named " + property.name() + "; rename one");
  }
  properties_.push_back(&property);
}

void TaskContext::addOperation(OperationBase& operation) {
  if (this->operation(operation.name()) != nullptr) {
    throw InputError("component " + name_ + " has two operations named " + operation.name() + "; rename one");
  }
  operations_.push_back(&operation);
}

PortBase* TaskContext::port(const std::string& name) const {
  return find(ports_, name);
}
PropertyBase* TaskContext::property(const std::string& name) const {
  return find(properties_, name);
}
OperationBase* TaskContext::operation(const std::string& name) const {
  return find(operations_, name);
}

}  // namespace knee_robot::rt
