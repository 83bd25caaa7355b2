#pragma once

#include <ros/ros.h>

#include <string>

namespace knee_robot::nodes {

/// Private parameters of a node. InputError with the parameter's full name where one is missing, of another type, or
/// outside what is allowed: a value that cannot be used is never replaced by the default without a word. `what` ends the
/// sentence "...; it is".
std::string requiredParameter(const ros::NodeHandle& node, const std::string& name);
double numberParameter(const ros::NodeHandle& node, const std::string& name, double otherwise, double minimum,
                       double maximum, const std::string& what);
bool switchParameter(const ros::NodeHandle& node, const std::string& name, bool otherwise, const std::string& what);
std::string textParameter(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise,
                          const std::string& what);
/// An absolute path: a folder that depends on where a node was started is another one at the next start.
std::string folderParameter(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise);

/// The same of a value that was read already; `name` is the full one.
double numberOf(const XmlRpc::XmlRpcValue& value, const std::string& name, double minimum, double maximum,
                const std::string& what);
bool switchOf(const XmlRpc::XmlRpcValue& value, const std::string& name, const std::string& what);
std::string textOf(const XmlRpc::XmlRpcValue& value, const std::string& name, const std::string& what);
std::string folderOf(const XmlRpc::XmlRpcValue& value, const std::string& name);

}  // namespace knee_robot::nodes
