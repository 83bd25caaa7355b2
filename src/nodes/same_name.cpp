#include "same_name.h"

#include <netdb.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpc.h>

#include <chrono>
#include <cstdint>
#include <memory>

namespace knee_robot::nodes {
namespace {

constexpr std::chrono::seconds kSameNamePatience{2};

/// A node that was killed is still in the master's list, and nobody listens where it was.
bool somebodyListens(const std::string& host, std::uint32_t port) {
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) return false;
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, ::freeaddrinfo);
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    const int descriptor = ::socket(address->ai_family, address->ai_socktype | SOCK_CLOEXEC, address->ai_protocol);
    if (descriptor < 0) continue;
    const timeval patience{kSameNamePatience.count(), 0};
    ::setsockopt(descriptor, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    const bool connected = ::connect(descriptor, address->ai_addr, address->ai_addrlen) == 0;
    ::close(descriptor);
    if (connected) return true;
  }
  return false;
}

/// `topics`: pairs of name and type, as getPublications answers; anything else publishes nothing.
bool publishesBelow(const std::string& prefix, XmlRpc::XmlRpcValue& topics) {
  if (topics.getType() != XmlRpc::XmlRpcValue::TypeArray) return false;
  for (int i = 0; i < topics.size(); ++i) {
    XmlRpc::XmlRpcValue& topic = topics[i];
    if (topic.getType() != XmlRpc::XmlRpcValue::TypeArray || topic.size() == 0) continue;
    if (topic[0].getType() != XmlRpc::XmlRpcValue::TypeString) continue;
    if (static_cast<const std::string&>(topic[0]).rfind(prefix, 0) == 0) return true;
  }
  return false;
}

/// False: a process answers that publishes nothing under this node's name; it was given the port of one that is gone. No
/// answer in time is one of a node that stands still.
bool isThisNode(const std::string& host, std::uint32_t port) {
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue request, response;
  request[0] = ros::this_node::getName();
  if (!client.executeNonBlock("getPublications", request)) return true;
  XmlRpc::XmlRpcDispatch dispatch;
  dispatch.addSource(&client, XmlRpc::XmlRpcDispatch::WritableEvent | XmlRpc::XmlRpcDispatch::Exception);
  const auto give_up = std::chrono::steady_clock::now() + kSameNamePatience;
  bool answered = false;
  while (!answered && std::chrono::steady_clock::now() < give_up) {
    dispatch.work(0.05);
    answered = client.executeCheckDone(response);
  }
  dispatch.removeSource(&client);
  if (!answered || client.isFault() || response.getType() != XmlRpc::XmlRpcValue::TypeArray || response.size() < 3)
    return true;
  return publishesBelow(ros::this_node::getName() + "/", response[2]);
}

}  // namespace

std::string nodeOfTheSameName() {
  XmlRpc::XmlRpcValue request, response, uri;
  request[0] = ros::this_node::getName();
  request[1] = ros::this_node::getName();
  if (!ros::master::check() || !ros::master::execute("lookupNode", request, response, uri, false)) return "";
  if (uri.getType() != XmlRpc::XmlRpcValue::TypeString) return "";
  const std::string where = static_cast<std::string>(uri);
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(where, host, port) || !somebodyListens(host, port) || !isThisNode(host, port)) return "";
  return where;
}

}  // namespace knee_robot::nodes
