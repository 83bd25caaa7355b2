#include "knee_robot/rt/port.h"

#include "knee_robot/base/errors.h"
#include "knee_robot/rt/operation.h"

namespace knee_robot::rt {

PortBase::PortBase(TaskContext& owner, std::string name, std::string description, std::type_index type)
    : owner_(owner.name()), name_(std::move(name)), description_(std::move(description)), type_(type) {
  owner.addPort(*this);
}

std::string PortBase::typeName() const {
  return rt::typeName(type_);
}

void connect(PortBase& output, PortBase& input, const ConnPolicy& policy) {
  if (!output.isOutput()) throw InputError(output.fullName() + " is an input: a connection begins at an output");
  if (input.isOutput()) throw InputError(input.fullName() + " is an output: a connection ends at an input");
  if (output.type() != input.type()) {
    throw InputError(output.fullName() + " sends " + output.typeName() + ", but " + input.fullName() + " takes " +
                     input.typeName() + ": connect ports of one type");
  }
  if (input.isConnected()) {
    throw InputError(input.fullName() + " is connected already: an input has one source; remove one connection");
  }
  if (policy.kind != ConnPolicy::Kind::Data && (policy.size < 1 || policy.size > 1'000'000)) {
    throw InputError(output.fullName() + " to " + input.fullName() + ": a buffer holds 1 to 1000000 values, not " +
                     std::to_string(policy.size));
  }
  output.connectTo(input, policy);
}

}  // namespace knee_robot::rt
