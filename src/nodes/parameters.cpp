#include "parameters.h"

#include <sstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"

namespace knee_robot::nodes {
namespace {

using XmlRpc::XmlRpcValue;

std::string shown(const XmlRpcValue& value) {
  if (value.getType() == XmlRpcValue::TypeString) return static_cast<std::string>(XmlRpcValue(value));
  if (value.getType() == XmlRpcValue::TypeBoolean) return static_cast<bool>(XmlRpcValue(value)) ? "true" : "false";
  std::ostringstream text;
  value.write(text);
  return text.str();
}

[[noreturn]] void refuseType(const XmlRpcValue& value, const std::string& name, const char* type,
                             const std::string& what) {
  throw InputError("parameter " + name + " is " + inQuotes(shown(value)) + ", not " + type + "; it is " + what);
}

/// Of the parameter where it is set, read by `of`; else `otherwise`.
template <typename Value, typename Of>
Value readParameter(const ros::NodeHandle& node, const std::string& name, const Value& otherwise, const Of& of) {
  XmlRpcValue value;
  return node.getParam(name, value) ? of(value, node.resolveName(name)) : otherwise;
}

}  // namespace

double numberOf(const XmlRpcValue& value, const std::string& name, double minimum, double maximum,
                const std::string& what) {
  double number = 0.0;
  if (value.getType() == XmlRpcValue::TypeInt)
    number = static_cast<int>(XmlRpcValue(value));
  else if (value.getType() == XmlRpcValue::TypeDouble)
    number = static_cast<double>(XmlRpcValue(value));
  else
    refuseType(value, name, "a number", what);
  if (!(number >= minimum && number <= maximum))
    throw InputError("parameter " + name + " is " + shortNumber(number, 6) + ", outside " + shortNumber(minimum, 6) +
                     " .. " + shortNumber(maximum, 6) + "; it is " + what);
  return number;
}

bool switchOf(const XmlRpcValue& value, const std::string& name, const std::string& what) {
  if (value.getType() != XmlRpcValue::TypeBoolean) refuseType(value, name, "true or false", what);
  return static_cast<bool>(XmlRpcValue(value));
}

std::string textOf(const XmlRpcValue& value, const std::string& name, const std::string& what) {
  if (value.getType() != XmlRpcValue::TypeString) refuseType(value, name, "a text", what);
  return static_cast<std::string>(XmlRpcValue(value));
}

std::string folderOf(const XmlRpcValue& value, const std::string& name) {
  const std::string folder = textOf(value, name, "a folder");
  if (folder.empty() || folder.front() != '/')
    throw InputError("parameter " + name + " is " + inQuotes(folder) +
                     ", not an absolute path: started from elsewhere, the controller would look in another folder");
  return folder;
}

std::string requiredParameter(const ros::NodeHandle& node, const std::string& name) {
  std::string value;
  if (!node.getParam(name, value) || value.empty()) {
    throw InputError("parameter " + node.resolveName(name) + " is missing; launch/controller.launch shows all of them");
  }
  return value;
}

double numberParameter(const ros::NodeHandle& node, const std::string& name, double otherwise, double minimum,
                       double maximum, const std::string& what) {
  return readParameter(node, name, otherwise, [&](const XmlRpcValue& value, const std::string& full) {
    return numberOf(value, full, minimum, maximum, what);
  });
}

bool switchParameter(const ros::NodeHandle& node, const std::string& name, bool otherwise, const std::string& what) {
  return readParameter(node, name, otherwise,
                       [&](const XmlRpcValue& value, const std::string& full) { return switchOf(value, full, what); });
}

std::string textParameter(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise,
                          const std::string& what) {
  return readParameter(node, name, otherwise,
                       [&](const XmlRpcValue& value, const std::string& full) { return textOf(value, full, what); });
}

std::string folderParameter(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise) {
  return readParameter(node, name, otherwise,
                       [](const XmlRpcValue& value, const std::string& full) { return folderOf(value, full); });
}

}  // namespace knee_robot::nodes
