#include "knee_robot/rt/operation.h"

#include <cxxabi.h>

#include <cstdlib>
#include <memory>

#include "knee_robot/base/errors.h"

namespace knee_robot::rt {

std::string typeName(std::type_index type) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> readable(abi::__cxa_demangle(type.name(), nullptr, nullptr, &status),
                                                        std::free);
  return status == 0 ? readable.get() : type.name();
}

OperationBase::OperationBase(TaskContext& owner, std::string name, std::vector<std::string> arguments,
                             std::string description, std::vector<std::string> types)
    : name_(std::move(name)),
      description_(std::move(description)),
      arguments_(std::move(arguments)),
      types_(std::move(types)) {
  if (arguments_.size() + 1 != types_.size()) {
    throw InputError("operation " + name_ + " takes " + std::to_string(types_.size() - 1) + " arguments, but " +
                     std::to_string(arguments_.size()) + " are named");
  }
  owner.addOperation(*this);
}

std::string OperationBase::signature() const {
  std::string text = types_[0] + " " + name_ + "(";
  for (std::size_t i = 0; i < arguments_.size(); ++i)
    text += (i == 0 ? "" : ", ") + types_[i + 1] + " " + arguments_[i];
  return text + ")";
}

}  // namespace knee_robot::rt
