#include "controller_timing.h"

#include <knee_robot/TimingHistograms.h>

#include <algorithm>
#include <type_traits>

namespace knee_robot::nodes {
namespace {

constexpr double kPublishPeriod = 10.0, kLogPeriod = 600.0;  // s

/// Both kinds of report have the same figures.
template <typename Report>
ComponentHistograms message(const std::string& activity, const std::string& component, std::uint64_t updates,
                            const Report& report) {
  ComponentHistograms message;
  message.activity = activity;
  message.component = component;
  message.period_s = rt::toSeconds(report.period);
  message.updates = updates;
  const auto copy = [](const rt::DurationHistogram::Snapshot& from, auto& to, double& largest) {
    static_assert(std::decay_t<decltype(to)>::static_size == rt::DurationHistogram::kBuckets);
    std::copy(from.buckets.begin(), from.buckets.end(), to.begin());
    largest = rt::toSeconds(from.max);
  };
  copy(report.periods, message.period, message.period_max_s);
  copy(report.lateness, message.lateness, message.lateness_max_s);
  copy(report.execution, message.execution, message.execution_max_s);
  return message;
}

}  // namespace

ControllerTiming::ControllerTiming(ros::NodeHandle& node, const control::ControlSystem& system)
    : system_(system),
      histograms_(node.advertise<TimingHistograms>("timing_histograms", 1, true)),
      logged_at_(ros::SteadyTime::now()) {
  timer_ =
      node.createSteadyTimer(ros::WallDuration(kPublishPeriod), [this](const ros::SteadyTimerEvent&) { publish(); });
}

void ControllerTiming::publish() {
  const std::vector<rt::ActivityReport> reports = system_.statistics();
  TimingHistograms all;
  all.header.stamp = ros::Time::now();
  for (const rt::ActivityReport& activity : reports) {
    all.histograms.push_back(message(activity.name, "", activity.cycles, activity));
    for (const rt::ComponentReport& component : activity.components)
      all.histograms.push_back(message(activity.name, component.name, component.updates, component));
  }
  histograms_.publish(all);
  const ros::SteadyTime now = ros::SteadyTime::now();
  if ((now - logged_at_).toSec() < kLogPeriod) return;
  logged_at_ = now;
  ROS_INFO("timing since the start:\n%s", rt::toText(reports).c_str());
}

}  // namespace knee_robot::nodes
