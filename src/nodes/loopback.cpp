#include "loopback.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <ros/network.h>
#include <sys/socket.h>
#include <xmlrpcpp/XmlRpcSocket.h>

#include <cstdint>
#include <string>

namespace {

bool isLoopback(const std::string& host) {
  return host == "localhost" || host.rfind("127.", 0) == 0;
}

}  // namespace

/// Takes the place of the library's own function in programs that link this file.
bool XmlRpc::XmlRpcSocket::bind(int socket, int port) {
  int family = 0;
  socklen_t size = sizeof family;
  const bool known = ::getsockopt(socket, SOL_SOCKET, SO_DOMAIN, &family, &size) == 0;
  if (!known || family != AF_INET || !isLoopback(ros::network::getHost())) {
    using Bind = bool (*)(int, int);
    const auto original = reinterpret_cast<Bind>(::dlsym(RTLD_NEXT, "_ZN6XmlRpc12XmlRpcSocket4bindEii"));
    return original != nullptr && original(socket, port);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

namespace knee_robot::nodes {

void keepToLoopback() {
  // Being linked is enough; the call sees to that.
}

}  // namespace knee_robot::nodes
