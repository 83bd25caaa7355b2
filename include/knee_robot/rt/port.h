#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "knee_robot/rt/channel.h"
#include "knee_robot/rt/tap.h"
#include "knee_robot/rt/task_context.h"

namespace knee_robot::rt {

/// What a read found.
enum class FlowStatus { NoData, OldData, NewData };

/// What a connection keeps between a write and the next read.
struct ConnPolicy {
  enum class Kind { Data, Buffer };
  Kind kind = Kind::Data;
  std::size_t size = 1;  ///< values kept by buffers

  static ConnPolicy data() { return {}; }
  static ConnPolicy buffer(std::size_t size) { return {Kind::Buffer, size}; }
};

/// Whether a component works without a connection to this input.
enum class Need { Required, Optional };

/// What all ports have in common: a name, an owner, a type, whether they are connected.
class PortBase {
 public:
  virtual ~PortBase() = default;
  PortBase(const PortBase&) = delete;
  PortBase& operator=(const PortBase&) = delete;

  const std::string& name() const { return name_; }
  /// "Component.port" for messages.
  std::string fullName() const { return owner_ + "." + name_; }
  const std::string& description() const { return description_; }
  std::type_index type() const { return type_; }
  /// Readable name of the carried type.
  std::string typeName() const;
  virtual bool isOutput() const = 0;
  virtual bool isConnected() const = 0;
  virtual bool isRequired() const { return false; }
  /// The output whose values come here: an output itself, or what an input is connected to; null: nothing is connected.
  virtual PortBase* source() { return this; }
  /// For an onlooker. Made at the first call and kept as long as the port; not real-time, one thread. Outputs only: ask
  /// source().
  virtual TapBase* tap() { return nullptr; }

 protected:
  PortBase(TaskContext& owner, std::string name, std::string description, std::type_index type);

 private:
  friend void connect(PortBase&, PortBase&, const ConnPolicy&);
  /// Only for outputs; `input` has the same type and is unconnected.
  virtual void connectTo(PortBase& /*input*/, const ConnPolicy& /*policy*/) {}

  const std::string owner_;
  const std::string name_;
  const std::string description_;
  const std::type_index type_;
};

/// Connects an output to an input. Not real-time; before the activities run. Throws InputError in one sentence when the
/// directions or types do not fit, when the input is connected already, or when the policy is senseless.
void connect(PortBase& output, PortBase& input, const ConnPolicy& policy = ConnPolicy::data());

template <typename T>
class OutputPort;

/// Receives values of one output. read() is wait-free, never allocates.
template <typename T>
class InputPort final : public PortBase {
  static_assert(std::is_trivially_copyable_v<T>, "ports carry trivially copyable values: no strings, no vectors");

 public:
  InputPort(TaskContext& owner, std::string name, std::string description, Need need = Need::Required)
      : PortBase(owner, std::move(name), std::move(description), typeid(T)), required_(need == Need::Required) {}

  /// NewData: `value` is the next value. OldData: `value` is the last one read. NoData: `value` is untouched.
  FlowStatus read(T& value) noexcept {
    if (!channel_) return FlowStatus::NoData;
    if (channel_->read(last_)) {
      ever_ = true;
      value = last_;
      return FlowStatus::NewData;
    }
    if (!ever_) return FlowStatus::NoData;
    value = last_;
    return FlowStatus::OldData;
  }
  bool isOutput() const override { return false; }
  bool isConnected() const override { return channel_ != nullptr; }
  bool isRequired() const override { return required_; }
  PortBase* source() override { return source_; }

 private:
  friend class OutputPort<T>;
  std::shared_ptr<Channel<T>> channel_;
  PortBase* source_ = nullptr;
  T last_{};
  bool ever_ = false;
  const bool required_;
};

/// Sends values to any number of inputs. write() is wait-free and never allocates.
template <typename T>
class OutputPort final : public PortBase {
  static_assert(std::is_trivially_copyable_v<T>, "ports carry trivially copyable values: no strings, no vectors");

 public:
  OutputPort(TaskContext& owner, std::string name, std::string description)
      : PortBase(owner, std::move(name), std::move(description), typeid(T)) {}

  /// False when at least one connection lost a value for want of room.
  bool write(const T& value) noexcept {
    if (Tap<T>* const tap = reached_.load(std::memory_order_acquire)) tap->write(value);
    bool kept = true;
    for (const auto& channel : channels_)
      kept = channel->write(value) && kept;
    return kept;
  }
  bool isOutput() const override { return true; }
  bool isConnected() const override { return !channels_.empty(); }
  TapBase* tap() override {
    if (!tap_) {
      tap_ = std::make_unique<Tap<T>>();
      reached_.store(tap_.get(), std::memory_order_release);
    }
    return tap_.get();
  }

 private:
  void connectTo(PortBase& input, const ConnPolicy& policy) override {
    std::shared_ptr<Channel<T>> channel;
    switch (policy.kind) {
      case ConnPolicy::Kind::Data:
        channel = std::make_shared<DataChannel<T>>();
        break;
      case ConnPolicy::Kind::Buffer:
        channel = std::make_shared<BufferChannel<T>>(policy.size);
        break;
    }
    static_cast<InputPort<T>&>(input).channel_ = channel;
    static_cast<InputPort<T>&>(input).source_ = this;
    channels_.push_back(std::move(channel));
  }
  std::vector<std::shared_ptr<Channel<T>>> channels_;
  std::unique_ptr<Tap<T>> tap_;
  std::atomic<Tap<T>*> reached_{nullptr};
};

}  // namespace knee_robot::rt
