#include "knee_robot/rt/deployer.h"

#include <algorithm>

#include "deployment_reader.h"
#include "knee_robot/base/errors.h"

namespace knee_robot::rt {

Deployment::Deployment(const std::string& path, const TypeFactory& factory, Execution execution)
    : path_(path), execution_(execution) {
  DeploymentReader(*this, factory).read();
}

Deployment::~Deployment() {
  stop();
}

TaskContext* Deployment::component(const std::string& name) const {
  for (const auto& one : components_) {
    if (one->name() == name) return one.get();
  }
  return nullptr;
}

Activity* Deployment::activity(const std::string& name) const {
  for (const auto& one : activities_) {
    if (one->name() == name) return one.get();
  }
  return nullptr;
}

Activity* Deployment::activityOf(const TaskContext& component) const {
  for (const auto& one : activities_) {
    const auto& executed = one->components();
    if (std::find(executed.begin(), executed.end(), &component) != executed.end()) return one.get();
  }
  return nullptr;
}

void Deployment::start() {
  for (const auto& component : components_) {
    if (!component->configure()) {
      throw InputError(path_ + ": component " + component->name() + " cannot be configured: " + component->refusal());
    }
  }
  warnings_.clear();
  epoch_ = monotonicNow();
  virtual_now_ = 0;
  try {
    for (const auto& activity : activities_) {
      for (std::string& sentence : activity->start(epoch_))
        warnings_.push_back(std::move(sentence));
    }
    startComponents();
  } catch (const InputError& error) {
    stop();
    throw InputError(path_ + ": " + error.what());
  }
}

void Deployment::startComponents() {
  for (TaskContext* component : start_order_) {
    if (!component->start()) {
      throw InputError("component " + component->name() + " did not start: " + component->refusal());
    }
  }
}

void Deployment::stop() noexcept {
  for (auto component = start_order_.rbegin(); component != start_order_.rend(); ++component) {
    if ((*component)->isRunning()) (*component)->stop();
  }
  for (auto activity = activities_.rbegin(); activity != activities_.rend(); ++activity)
    (*activity)->stop();
  // A thread that did not answer in time: now that it has ended, its components are stopped from here.
  for (auto component = start_order_.rbegin(); component != start_order_.rend(); ++component) {
    if ((*component)->isRunning()) (*component)->stop();
  }
}

Nanoseconds Deployment::step() {
  virtual_now_ = stepEarliest(stepped_);
  return virtual_now_;
}

void Deployment::skip(Nanoseconds duration) noexcept {
  const Nanoseconds end = nextRelease() + duration;
  for (SteppedActivity* activity : stepped_) {
    const Nanoseconds period = activity->options().period;
    const std::int64_t cycles = (end - activity->nextRelease() + period - 1) / period;
    if (cycles > 0) activity->skip(cycles);
  }
}

Nanoseconds Deployment::nextRelease() const noexcept {
  const auto earlier = [](const SteppedActivity* a, const SteppedActivity* b) {
    return a->nextRelease() < b->nextRelease();
  };
  const auto first = std::min_element(stepped_.begin(), stepped_.end(), earlier);
  return first == stepped_.end() ? 0 : (*first)->nextRelease();
}

void Deployment::stepUntil(Nanoseconds end) {
  while (!stepped_.empty() && nextRelease() < end)
    step();
}

Nanoseconds Deployment::now() const noexcept {
  return execution_ == Execution::Stepped ? virtual_now_ : monotonicNow() - epoch_;
}

}  // namespace knee_robot::rt
