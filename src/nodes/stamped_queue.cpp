#include "stamped_queue.h"

#include <boost/make_shared.hpp>

namespace knee_robot::nodes {
namespace {

thread_local std::uint64_t stamp_now = 0;

class Stamped : public ros::CallbackInterface {
 public:
  Stamped(ros::CallbackInterfacePtr callback, std::uint64_t stamp) : callback_(std::move(callback)), stamp_(stamp) {}
  CallResult call() override {
    stamp_now = stamp_;
    return callback_->call();
  }
  bool ready() override { return callback_->ready(); }

 private:
  const ros::CallbackInterfacePtr callback_;
  const std::uint64_t stamp_;
};

}  // namespace

void StampedQueue::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t removal_id) {
  ros::CallbackQueue::addCallback(boost::make_shared<Stamped>(callback, counter_()), removal_id);
}

std::uint64_t StampedQueue::stamp() noexcept {
  return stamp_now;
}

}  // namespace knee_robot::nodes
