#include "master_watch.h"

#include <knee_robot/GetState.h>
#include <ros/connection_manager.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/service.h>
#include <ros/this_node.h>

#include <algorithm>

namespace knee_robot::nodes {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(500);

/// Where roscpp tells the master that this process serves.
std::string ownAddress() {
  return "rosrpc://" + ros::network::getHost() + ":" + std::to_string(ros::ConnectionManager::instance()->getTCPPort());
}

}  // namespace

MasterWatch::MasterWatch(std::string service, std::vector<std::string> others)
    : service_(std::move(service)),
      others_(std::move(others)),
      answered_(Clock::now().time_since_epoch().count()),
      reached_(answered_.load()),
      thread_([this] { run(); }) {}

MasterWatch::~MasterWatch() {
  ended_ = true;
  thread_.join();
}

double MasterWatch::since(Clock::rep time) {
  return std::chrono::duration<double>(Clock::now().time_since_epoch() - Clock::duration(time)).count();
}

/// False also when the master went away in between: advertising anew is harmless then.
bool MasterWatch::finds(const std::string& service) {
  XmlRpc::XmlRpcValue request, response, address;
  request[0] = ros::this_node::getName();
  request[1] = service;
  if (!ros::master::execute("lookupService", request, response, address, false)) return false;
  const bool own =
      address.getType() == XmlRpc::XmlRpcValue::TypeString && static_cast<const std::string&>(address) == ownAddress();
  if (!own) robbed_ = true;
  return own;
}

bool MasterWatch::findsAll() {
  return finds(service_) &&
         std::all_of(others_.begin(), others_.end(), [this](const std::string& other) { return finds(other); });
}

void MasterWatch::run() {
  auto next = Clock::now();
  while (!ended_) {
    if (ros::master::check()) {
      answered_ = Clock::now().time_since_epoch().count();
      GetState call;
      if (!findsAll())
        forgotten_ = true;
      else if (ros::service::call(service_, call))
        reached_ = Clock::now().time_since_epoch().count();
    }
    next = std::max(next + kPeriod, Clock::now());
    while (!ended_ && Clock::now() < next)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

}  // namespace knee_robot::nodes
