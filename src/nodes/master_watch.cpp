#include "master_watch.h"

#include <ros/master.h>
#include <ros/this_node.h>

namespace knee_robot::nodes {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(500);

}  // namespace

MasterWatch::MasterWatch(std::string service)
    : service_(std::move(service)), answered_(Clock::now().time_since_epoch().count()), thread_([this] { run(); }) {}

MasterWatch::~MasterWatch() {
  ended_ = true;
  thread_.join();
}

double MasterWatch::silence() const {
  const Clock::duration since = Clock::now().time_since_epoch() - Clock::duration(answered_.load());
  return std::chrono::duration<double>(since).count();
}

void MasterWatch::run() {
  auto next = Clock::now();
  while (!ended_) {
    if (ros::master::check()) {
      answered_ = Clock::now().time_since_epoch().count();
      XmlRpc::XmlRpcValue request, response, payload;
      request[0] = ros::this_node::getName();
      request[1] = service_;
      // False also when the master went away in between: advertising anew is harmless then.
      if (!ros::master::execute("lookupService", request, response, payload, false)) forgotten_ = true;
    }
    next = std::max(next + kPeriod, Clock::now());
    while (!ended_ && Clock::now() < next)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

}  // namespace knee_robot::nodes
