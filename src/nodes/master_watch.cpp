#include "master_watch.h"

#include <knee_robot/GetState.h>
#include <ros/master.h>
#include <ros/service.h>
#include <ros/this_node.h>

namespace knee_robot::nodes {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(500);

}  // namespace

MasterWatch::MasterWatch(std::string service)
    : service_(std::move(service)),
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
bool MasterWatch::findsItself() const {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = service_;
  return ros::master::execute("lookupService", request, response, payload, false);
}

void MasterWatch::run() {
  auto next = Clock::now();
  while (!ended_) {
    if (ros::master::check()) {
      answered_ = Clock::now().time_since_epoch().count();
      GetState call;
      if (!findsItself())
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
