#include "goal_stamps.h"

namespace actionlib {
namespace {

/// A stamp that has not come yet counts as now: such an entry goes like the others.
bool isOver(ros::Time& since, const ros::Duration& kept, const ros::Time& now) {
  if (since == ros::Time()) return false;
  if (since > now) since = now;
  return now.toSec() - since.toSec() > kept.toSec();
}

}  // namespace

template <>
void ActionServer<knee_robot::PlayAction>::publishStatus() {
  const boost::recursive_mutex::scoped_lock lock(this->lock_);
  actionlib_msgs::GoalStatusArray all;
  all.header.stamp = ros::Time::now();
  for (auto one = this->status_list_.begin(); one != this->status_list_.end();) {
    all.status_list.push_back(one->status_);
    one = isOver(one->handle_destruction_time_, this->status_list_timeout_, all.header.stamp)
              ? this->status_list_.erase(one)
              : std::next(one);
  }
  status_pub_.publish(all);
}

}  // namespace actionlib
