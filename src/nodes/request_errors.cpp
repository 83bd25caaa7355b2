#include "request_errors.h"

#include <dlfcn.h>
#include <xmlrpcpp/XmlRpcException.h>
#include <xmlrpcpp/XmlRpcServerConnection.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <exception>
#include <string>

/// Takes the place of the library's own function in programs that link this file.
bool XmlRpc::XmlRpcServerConnection::executeMethod(const std::string& name, XmlRpcValue& parameters,
                                                   XmlRpcValue& result) {
  using Execute = bool (*)(XmlRpcServerConnection*, const std::string&, XmlRpcValue&, XmlRpcValue&);
  static const auto original = reinterpret_cast<Execute>(
      ::dlsym(RTLD_NEXT,
              "_ZN6XmlRpc22XmlRpcServerConnection13executeMethodERKNSt7__cxx1112basic_stringIcSt11char_"
              "traitsIcESaIcEEERNS_11XmlRpcValueESA_"));
  if (original == nullptr) return false;
  // No node needs it, and one within another reads what is not there.
  if (name == "system.multicall") throw XmlRpcException("requests within a request are not served");
  try {
    return original(this, name, parameters, result);
  } catch (const std::exception&) {
    // No words of the request: the answer is XML, and the library escapes nothing in it.
    throw XmlRpcException("the request cannot be served");
  }
}

namespace knee_robot::nodes {

void answerRequestErrors() {
  // Being linked is enough; the call sees to that.
}

}  // namespace knee_robot::nodes
