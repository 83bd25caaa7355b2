#include "controller_services.h"

#include "controller_topics.h"
#include "knee_robot/base/errors.h"
#include "played_goal.h"

namespace knee_robot::nodes {
namespace {

template <typename Response>
bool reply(const std::string& name, const knee_robot::control::Answer& answer, Response& response) {
  response.success = answer.ok;
  response.message = answer.sentence;
  if (answer.ok) ROS_INFO("%s: %s", name.c_str(), answer.sentence.c_str());
  if (!answer.ok) ROS_WARN("%s refused: %s", name.c_str(), answer.sentence.c_str());
  return true;
}

}  // namespace

ControllerServices::ControllerServices(ros::NodeHandle& commands, ros::NodeHandle& stops,
                                       control::ControlSystem& system, References& references, const Folder& patients,
                                       const Folder& recordings)
    : system_(system), references_(references), patients_(patients), recordings_(recordings) {
  offer(stops, "emergency_stop", [this] { return system_.emergencyStop(); });
  offer(stops, "stop", [this] { return system_.stop(); });
  offer(stops, "pause", [this] { return system_.pause(); });
  offer(stops, "disable", [this] { return system_.disable(); });
  servers_.push_back(stops.advertiseService("set_speed", &ControllerServices::setSpeed, this));
  offer(commands, "home", [this] { return system_.home(); });
  offer(commands, "confirm_home", [this] { return system_.confirmHome(); });
  offer(commands, "enable", [this] { return system_.enable(); });
  offer(commands, "approach", [this] { return system_.approach(); });
  offer(commands, "start", [this] { return system_.play(); });
  offer(commands, "resume", [this] { return system_.resume(); });
  offer(commands, "reset_faults", [this] { return system_.resetFaults(); });
  servers_.push_back(commands.advertiseService("check_reference", &ControllerServices::check, this));
  servers_.push_back(commands.advertiseService("load_reference", &ControllerServices::load, this));
  servers_.push_back(commands.advertiseService("load_patient", &ControllerServices::loadPatient, this));
  offer(commands, "clear_patient", [this] { return system_.clearPatient(); });
  offer(commands, "declare_empty", [this] { return system_.declareEmpty(); });
  servers_.push_back(commands.advertiseService("set_recording", &ControllerServices::record, this));
  servers_.push_back(stops.advertiseService("get_state", &ControllerServices::getState, this));
}

void ControllerServices::offer(ros::NodeHandle& node, const std::string& name,
                               std::function<control::Answer()> command) {
  using Request = std_srvs::Trigger::Request;
  using Response = std_srvs::Trigger::Response;
  const boost::function<bool(Request&, Response&)> serve = [name, command](Request&, Response& response) {
    return reply(name, command(), response);
  };
  servers_.push_back(node.advertiseService(name, serve));
}

bool ControllerServices::check(CheckReference::Request& request, CheckReference::Response& response) {
  const JudgedReference judged = references_.judge(request.file, request.space);
  response.points = judged.points;
  response.duration_s = judged.duration_s;
  return reply("check_reference", judged.answer, response);
}

bool ControllerServices::load(LoadReference::Request& request, LoadReference::Response& response) {
  const JudgedReference judged = references_.judge(request.file, request.space);
  response.points = judged.points;
  response.duration_s = judged.duration_s;
  return reply("load_reference", references_.load(judged), response);
}

bool ControllerServices::loadPatient(LoadPatient::Request& request, LoadPatient::Response& response) {
  try {
    return reply("load_patient", system_.loadPatient(patients_.existingFile(request.file)), response);
  } catch (const InputError& error) {
    return reply("load_patient", {false, error.what()}, response);
  }
}

bool ControllerServices::record(SetRecording::Request& request, SetRecording::Response& response) {
  try {
    const control::Answer answer =
        request.record
            ? system_.startRecording(recordings_.newFile(request.file.empty() ? nameAfterTheTime() : request.file))
            : system_.stopRecording();
    return reply("set_recording", answer, response);
  } catch (const InputError& error) {
    return reply("set_recording", {false, error.what()}, response);
  }
}

bool ControllerServices::setSpeed(SetSpeed::Request& request, SetSpeed::Response& response) {
  return reply("set_speed", system_.setSpeed(request.percent), response);
}

bool ControllerServices::getState(GetState::Request& /*request*/, GetState::Response& response) {
  response.state = stateMessage(system_);
  return true;
}

}  // namespace knee_robot::nodes
