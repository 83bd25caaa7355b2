#pragma once

#include <functional>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "knee_robot/rt/task_context.h"

namespace knee_robot::rt {

/// Something that other threads may call on a component, with what it does and what it takes: so that a list of them
/// says how to use the component. The life-cycle commands (configure, start, ...) are the same for all and not in it.
class OperationBase {
 public:
  virtual ~OperationBase() = default;
  OperationBase(const OperationBase&) = delete;
  OperationBase& operator=(const OperationBase&) = delete;

  const std::string& name() const { return name_; }
  const std::string& description() const { return description_; }
  /// As C++ would have it: "double step(double period_s)".
  std::string signature() const;

 protected:
  /// `arguments`: a name for each of `types`, of which the first is the result's. Throws InputError when they do not
  /// fit or when the owner has such an operation already.
  OperationBase(TaskContext& owner, std::string name, std::vector<std::string> arguments, std::string description,
                std::vector<std::string> types);

 private:
  const std::string name_, description_;
  const std::vector<std::string> arguments_, types_;
};

/// Readable name of a type.
std::string typeName(std::type_index type);

template <typename Signature>
class Operation;

/// Runs in the calling thread (RTT's ClientThread), never in the activity's: `function` says itself how it reaches the
/// hooks.
template <typename Result, typename... Arguments>
class Operation<Result(Arguments...)> final : public OperationBase {
 public:
  Operation(TaskContext& owner, std::string name, std::vector<std::string> arguments, std::string description,
            std::function<Result(Arguments...)> function)
      : OperationBase(owner, std::move(name), std::move(arguments), std::move(description),
                      {typeName(typeid(Result)), typeName(typeid(Arguments))...}),
        function_(std::move(function)) {}

  Result operator()(Arguments... arguments) const { return function_(arguments...); }

 private:
  const std::function<Result(Arguments...)> function_;
};

}  // namespace knee_robot::rt
