#include "controller_services.h"

#include <ctime>

#include "controller_topics.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot {
namespace {

std::optional<Space> requestedSpace(const std::string& name) {
  if (name.empty()) return std::nullopt;
  const std::optional<Space> space = spaceNamed(name);
  if (!space)
    throw InputError("'" + name.substr(0, 40) + "' is no space: use actuator, platform or relative, or leave it empty");
  return space;
}

std::string nameAfterTheTime() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char name[64];
  std::strftime(name, sizeof name, "recording_%Y-%m-%d_%H-%M-%S.csv", &local);
  return name;
}

/// "ok" with the margin that is smallest.
std::string marginSentence(const ReferenceCheck& check) {
  const Margin* nearest = nullptr;
  for (const Margin& margin : check.margins) {
    if (nearest == nullptr || margin.left < nearest->left) nearest = &margin;
  }
  if (nearest == nullptr) return "";
  return "; nearest to its limit is " + std::string(nameOf(nearest->quantity)) + " with " +
         shortNumber(100.0 * nearest->left, 3) + " % left, line " + std::to_string(nearest->line);
}

/// Fills the common part of both responses; returns the reference when it may be played.
template <typename Request, typename Response>
std::optional<Reference> readAndCheck(const Request& request, Response& response, const Robot& robot,
                                      const Folder& folder) {
  try {
    const Reference reference = readReference(folder.existingFile(request.file), requestedSpace(request.space));
    const ReferenceCheck checked = requirePlayable(reference, robot);
    response.points = static_cast<std::uint32_t>(reference.points.rows());
    response.duration_s = static_cast<double>(reference.points.rows() - 1) * reference.period_s;
    response.success = true;
    response.message = reference.name + ": may be played" + marginSentence(checked);
    return reference;
  } catch (const InputError& error) {
    response.success = false;
    response.message = error.what();
    return std::nullopt;
  }
}

}  // namespace

ControllerServices::ControllerServices(ros::NodeHandle& node, ControlSystem& system, const Robot& robot,
                                       const Folder& references, const Folder& recordings)
    : system_(system), robot_(robot), references_(references), recordings_(recordings) {
  servers_.push_back(node.advertiseService("check_reference", &ControllerServices::check, this));
  servers_.push_back(node.advertiseService("load_reference", &ControllerServices::load, this));
  servers_.push_back(node.advertiseService("set_recording", &ControllerServices::record, this));
  servers_.push_back(node.advertiseService("get_state", &ControllerServices::getState, this));
  offer(node, "enable", &ControlSystem::enable);
  offer(node, "disable", &ControlSystem::disable);
  offer(node, "start", &ControlSystem::play);
  offer(node, "stop", &ControlSystem::stop);
  offer(node, "emergency_stop", &ControlSystem::emergencyStop);
  offer(node, "reset_faults", &ControlSystem::resetFaults);
  const boost::function<bool(std_srvs::Trigger::Request&, std_srvs::Trigger::Response&)> approach =
      [this](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
        const Answer answer = system_.approach();
        response.success = answer.ok;
        response.message = answer.sentence;
        return true;
      };
  servers_.push_back(node.advertiseService("approach", approach));
}

void ControllerServices::offer(ros::NodeHandle& node, const std::string& name, Answer (ControlSystem::*command)()) {
  const boost::function<bool(std_srvs::Trigger::Request&, std_srvs::Trigger::Response&)> serve =
      [this, name, command](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
        const Answer answer = (system_.*command)();
        response.success = answer.ok;
        response.message = answer.sentence;
        if (answer.ok) ROS_INFO("%s: %s", name.c_str(), answer.sentence.c_str());
        if (!answer.ok) ROS_WARN("%s refused: %s", name.c_str(), answer.sentence.c_str());
        return true;
      };
  servers_.push_back(node.advertiseService(name, serve));
}

bool ControllerServices::check(CheckReference::Request& request, CheckReference::Response& response) {
  readAndCheck(request, response, robot_, references_);
  return true;
}

bool ControllerServices::load(LoadReference::Request& request, LoadReference::Response& response) {
  const std::optional<Reference> reference = readAndCheck(request, response, robot_, references_);
  if (reference) {
    const Answer answer = system_.loadReference(*reference);
    response.success = answer.ok;
    response.message = answer.ok ? response.message + "; loaded" : answer.sentence;
  }
  if (!response.success) ROS_WARN("load_reference refused: %s", response.message.c_str());
  return true;
}

bool ControllerServices::record(SetRecording::Request& request, SetRecording::Response& response) {
  try {
    const Answer answer =
        request.record
            ? system_.startRecording(recordings_.newFile(request.file.empty() ? nameAfterTheTime() : request.file))
            : system_.stopRecording();
    response.success = answer.ok;
    response.message = answer.sentence;
  } catch (const InputError& error) {
    response.success = false;
    response.message = error.what();
  }
  return true;
}

bool ControllerServices::getState(GetState::Request& /*request*/, GetState::Response& response) {
  response.state = stateMessage(system_);
  return true;
}

}  // namespace knee_robot
