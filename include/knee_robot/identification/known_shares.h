#pragma once

#include <Eigen/Core>
#include <map>
#include <mutex>
#include <utility>

#include "knee_robot/dynamics/friction_law.h"

namespace knee_robot::identification {

/// What elements of friction do along one path, kept: choosing a law tries the same elements again after every effect
/// that was found. Any thread may call it.
class KnownShares {
 public:
  /// Share per sample of `element`, whose own share does not matter, from `compute()` when it is asked for the first
  /// time. Of a long recording only the first elements are kept.
  template <typename Compute>
  Eigen::VectorXd of(const dynamics::FrictionElement& element, const Compute& compute) {
    const Key key = element.shape();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto found = shares_.find(key);
      if (found != shares_.end()) return found->second;
    }
    Eigen::VectorXd share = compute();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (numbers_ + share.size() <= kMostNumbers && shares_.emplace(key, share).second) numbers_ += share.size();
    return share;
  }

 private:
  static constexpr Eigen::Index kMostNumbers = 4'000'000;  // 32 MB a path
  using Key = decltype(std::declval<dynamics::FrictionElement>().shape());
  std::mutex mutex_;
  std::map<Key, Eigen::VectorXd> shares_;
  Eigen::Index numbers_ = 0;
};

}  // namespace knee_robot::identification
