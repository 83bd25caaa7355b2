#include "controller_services.h"

#include "controller_topics.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "played_goal.h"
#include "stamped_queue.h"
#include "terminal.h"

namespace knee_robot::nodes {
namespace {

/// That nothing of it has changed when a path begins.
control::PathExpectation expecting(const control::WishesSoFar& since) {
  return {"", since.halts, since.pauses, since.loaded};
}

}  // namespace

ControllerServices::ControllerServices(ros::NodeHandle& commands, ros::NodeHandle& stops,
                                       control::ControlSystem& system, References& references, const Folder& patients,
                                       const Folder& recordings, EventLog& log)
    : system_(system), references_(references), patients_(patients), recordings_(recordings), log_(log) {
  offer(stops, "emergency_stop", [this] { return system_.emergencyStop(); });
  offer(stops, "stop", [this] { return system_.stop(); });
  offer(stops, "pause", [this] { return system_.pause(); });
  offer(stops, "disable", [this] { return system_.disable(); });
  servers_.push_back(stops.advertiseService("set_speed", &ControllerServices::setSpeed, this));
  offerMotion(commands, "home", [this](Stops since) { return system_.home(since.halts); });
  offer(commands, "confirm_home", [this] { return system_.confirmHome(); });
  offerMotion(commands, "enable", [this](Stops since) { return system_.enable(since.halts); });
  offerMotion(commands, "approach", [this](Stops since) { return system_.approach(0.01, expecting(since)); });
  offerMotion(commands, "start", [this](Stops since) { return system_.play(expecting(since)); });
  offerMotion(commands, "resume", [this](Stops since) { return system_.resume(since); });
  offerMotion(commands, "guide", [this](Stops since) { return system_.guide(since.halts); });
  servers_.push_back(commands.advertiseService("save_guided", &ControllerServices::saveGuided, this));
  offer(commands, "reset_faults", [this] { return system_.resetFaults(); });
  servers_.push_back(commands.advertiseService("check_reference", &ControllerServices::check, this));
  servers_.push_back(commands.advertiseService("load_reference", &ControllerServices::load, this));
  servers_.push_back(commands.advertiseService("load_patient", &ControllerServices::loadPatient, this));
  offer(commands, "clear_patient", [this] { return changed(system_.clearPatient()); });
  offer(commands, "declare_empty", [this] { return changed(system_.declareEmpty()); });
  servers_.push_back(commands.advertiseService("set_recording", &ControllerServices::record, this));
  servers_.push_back(stops.advertiseService("get_state", &ControllerServices::getState, this));
}

/// `what`: the request with its arguments, for the event log.
template <typename Event>
bool ControllerServices::reply(Event& call, const std::string& what, const control::Answer& answer) {
  call.getResponse().success = answer.ok;
  call.getResponse().message = answer.sentence;
  showAnswer(what.substr(0, what.find(' ')), answer);
  log_.request(call.getCallerName(), what, answer);
  return true;
}

void ControllerServices::offer(ros::NodeHandle& node, const std::string& name,
                               std::function<control::Answer()> command) {
  using Trigger = ros::ServiceEvent<std_srvs::Trigger::Request, std_srvs::Trigger::Response>;
  const boost::function<bool(Trigger&)> serve = [this, name, command](Trigger& call) {
    return reply(call, name, command());
  };
  servers_.push_back(node.advertiseService(name, serve));
}

void ControllerServices::offerMotion(ros::NodeHandle& node, const std::string& name,
                                     std::function<control::Answer(Stops)> command) {
  offer(node, name, [this, command] { return command(StampedQueue::stamp()); });
}

bool ControllerServices::check(Call<CheckReference>& call) {
  const CheckedReference checked = references_.check(call.getRequest().file, call.getRequest().space);
  call.getResponse().points = checked.points;
  call.getResponse().duration_s = checked.duration_s;
  return reply(call, "check_reference " + call.getRequest().file, checked.answer);
}

bool ControllerServices::load(Call<LoadReference>& call) {
  const CheckedReference checked = references_.check(call.getRequest().file, call.getRequest().space);
  call.getResponse().points = checked.points;
  call.getResponse().duration_s = checked.duration_s;
  return reply(call, "load_reference " + call.getRequest().file, references_.load(checked));
}

/// Answers as load_reference would for the new file.
bool ControllerServices::saveGuided(Call<LoadReference>& call) {
  const std::string what = "save_guided " + call.getRequest().file;
  try {
    const std::string path = references_.newFile(call.getRequest().file);
    const control::SavedReference saved = system_.saveGuided(path);
    call.getResponse().points = saved.points;
    call.getResponse().duration_s = saved.duration_s;
    return reply(call, what, saved);
  } catch (const InputError& error) {
    return reply(call, what, {false, error.what()});
  }
}

/// An answer about who is on the robot.
control::Answer ControllerServices::changed(control::Answer answer) {
  if (answer.ok) references_.followOccupancy();
  return answer;
}

bool ControllerServices::loadPatient(Call<LoadPatient>& call) {
  const std::string what = "load_patient " + call.getRequest().file;
  try {
    return reply(call, what, changed(system_.loadPatient(patients_.existingFile(call.getRequest().file))));
  } catch (const InputError& error) {
    return reply(call, what, {false, error.what()});
  }
}

bool ControllerServices::record(Call<SetRecording>& call) {
  const SetRecording::Request& request = call.getRequest();
  const std::string what = "set_recording " + (request.record ? request.file : "(end)");
  try {
    const control::Answer answer =
        request.record
            ? system_.startRecording(recordings_.newFile(request.file.empty() ? nameAfterTheTime() : request.file))
            : system_.stopRecording();
    return reply(call, what, answer);
  } catch (const InputError& error) {
    return reply(call, what, {false, error.what()});
  }
}

bool ControllerServices::setSpeed(Call<SetSpeed>& call) {
  const double percent = call.getRequest().percent;
  return reply(call, "set_speed " + shortNumber(percent) + " %", system_.setSpeed(percent));
}

bool ControllerServices::getState(GetState::Request& /*request*/, GetState::Response& response) {
  response.state = stateMessage(system_);
  return true;
}

}  // namespace knee_robot::nodes
