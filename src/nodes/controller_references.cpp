#include "controller_references.h"

#include <algorithm>
#include <filesystem>

#include "controller_pose.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::nodes {
namespace {

constexpr Eigen::Index kMostPathPoints = 4000;

std::optional<trajectory::Space> requestedSpace(const std::string& name) {
  if (name.empty()) return std::nullopt;
  const std::optional<trajectory::Space> space = trajectory::spaceNamed(name);
  if (!space)
    throw InputError("'" + name.substr(0, 40) + "' is no space: use actuator, platform or relative, or leave it empty");
  return space;
}

std::string marginSentence(const trajectory::ReferenceCheck& check) {
  const auto nearest =
      std::min_element(check.margins.begin(), check.margins.end(),
                       [](const trajectory::Margin& a, const trajectory::Margin& b) { return a.left < b.left; });
  if (nearest == check.margins.end()) return "";
  return "; nearest to its limit is " + std::string(trajectory::nameOf(nearest->quantity)) + " with " +
         shortNumber(100.0 * nearest->left, 3) + " % left, line " + std::to_string(nearest->line);
}

}  // namespace

CheckedReference References::check(const std::string& file, const std::string& space) const {
  CheckedReference checked;
  try {
    trajectory::Reference reference = trajectory::readReference(folder_.existingFile(file), requestedSpace(space));
    const std::string name = std::filesystem::path(reference.name).lexically_relative(folder_.path()).string();
    const double period_s = reference.period_s;
    control::PlayableReference playable = system_.check(std::move(reference));
    playable.rename(name);
    const Eigen::Index rows = playable.reference().points.rows();
    checked.points = static_cast<std::uint32_t>(rows);
    checked.duration_s = static_cast<double>(rows - 1) * period_s;
    checked.answer = {true, name + ": may be played" + marginSentence(playable.check())};
    if (const std::string why = system_.whyNotForPatient(playable); !why.empty())
      checked.answer = {false, why};
    else
      checked.playable = std::move(playable);
  } catch (const std::exception& error) {  // InputError, a file system that fails, no memory
    checked.answer = {false, error.what()};
  }
  return checked;
}

control::Answer References::load(const CheckedReference& checked) {
  if (!checked.playable) return checked.answer;
  const std::lock_guard<std::mutex> one_at_a_time(loading_);
  const control::Answer answer = system_.loadReference(*checked.playable);
  if (!answer.ok) return answer;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    duration_s_ = checked.duration_s;
  }
  publishPath(checked.playable->check(), checked.playable->reference().period_s);
  return {true, checked.answer.sentence + "; loaded"};
}

void References::followOccupancy() {
  const std::lock_guard<std::mutex> one_at_a_time(loading_);
  if (!system_.status().reference.empty()) return;  // somebody has loaded another one since
  const std::lock_guard<std::mutex> lock(mutex_);
  duration_s_ = 0.0;
  if (path_.poses.empty()) return;
  path_.header.stamp = ros::Time::now();
  path_.poses.clear();
  publisher_.publish(path_);
}

double References::loadedDuration() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return duration_s_;
}

void References::advertise(ros::NodeHandle& node) {
  const std::lock_guard<std::mutex> lock(mutex_);
  publisher_ = node.advertise<nav_msgs::Path>("path", 1, true);
  if (!path_.poses.empty()) publisher_.publish(path_);
}

void References::withdraw() {
  const std::lock_guard<std::mutex> lock(mutex_);
  publisher_ = ros::Publisher();
}

void References::publishPath(const trajectory::ReferenceCheck& check, double period_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  path_.header.stamp = ros::Time::now();
  path_.header.frame_id = kBaseFrame;
  path_.poses.clear();
  const Eigen::Index rows = check.poses.rows();
  const Eigen::Index stride = std::max<Eigen::Index>(5, (rows + kMostPathPoints - 1) / kMostPathPoints);
  for (Eigen::Index k = 0; k < rows; k = k + stride < rows || k == rows - 1 ? k + stride : rows - 1) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = kBaseFrame;
    pose.header.stamp.fromSec(static_cast<double>(k) * period_s);
    pose.pose = poseMessage(check.poses.row(k).transpose());
    path_.poses.push_back(pose);
  }
  publisher_.publish(path_);
}

}  // namespace knee_robot::nodes
