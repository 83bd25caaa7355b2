#include "stamped_queue.h"

#include <boost/make_shared.hpp>

namespace knee_robot::nodes {
namespace {

thread_local control::WishesSoFar stamp_now;

class Stamped : public ros::CallbackInterface {
 public:
  Stamped(ros::CallbackInterfacePtr callback, control::WishesSoFar stamp)
      : callback_(std::move(callback)), stamp_(stamp) {}
  CallResult call() override {
    stamp_now = stamp_;
    return callback_->call();
  }
  bool ready() override { return callback_->ready(); }

 private:
  const ros::CallbackInterfacePtr callback_;
  const control::WishesSoFar stamp_;
};

}  // namespace

void StampedQueue::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t removal_id) {
  ros::CallbackQueue::addCallback(boost::make_shared<Stamped>(callback, stops_()), removal_id);
}

control::WishesSoFar StampedQueue::stamp() noexcept {
  return stamp_now;
}

}  // namespace knee_robot::nodes
