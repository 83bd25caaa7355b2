#pragma once

#include <knee_robot/CheckReference.h>
#include <knee_robot/GetState.h>
#include <knee_robot/LoadPatient.h>
#include <knee_robot/LoadReference.h>
#include <knee_robot/SetRecording.h>
#include <knee_robot/SetSpeed.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <string>
#include <vector>

#include "controller_references.h"
#include "event_log.h"
#include "folder.h"
#include "knee_robot/control/control_system.h"

namespace knee_robot::nodes {

/// The operator's commands as services. Every answer says what happened, or why it did not, and stands in the event log
/// with who asked.
///
///     ~check_reference, ~load_reference   files of the references folder only
///     ~load_patient, ~clear_patient       files of the folder of patient files only
///     ~home, ~confirm_home, ~enable, ~approach, ~start, ~resume, ~reset_faults   std_srvs/Trigger
///     ~pause, ~stop, ~disable, ~emergency_stop                                   std_srvs/Trigger
///     ~guide (std_srvs/Trigger), ~save_guided: a new file of the references folder
///     ~set_speed, ~set_recording, ~get_state
class ControllerServices {
 public:
  /// `commands` and `stops` are the same private namespace with callback queues of their own: what makes the robot
  /// slower or stops it never waits behind a command that takes its time. ~get_state is advertised last.
  ControllerServices(ros::NodeHandle& commands, ros::NodeHandle& stops, control::ControlSystem& system,
                     References& references, const Folder& patients, const Folder& recordings, EventLog& log);

 private:
  using Stops = control::WishesSoFar;
  template <typename Service>
  using Call = ros::ServiceEvent<typename Service::Request, typename Service::Response>;

  bool check(Call<CheckReference>& call);
  bool load(Call<LoadReference>& call);
  bool saveGuided(Call<LoadReference>& call);
  control::Answer changed(control::Answer answer);
  bool loadPatient(Call<LoadPatient>& call);
  bool record(Call<SetRecording>& call);
  bool setSpeed(Call<SetSpeed>& call);
  bool getState(GetState::Request& request, GetState::Response& response);
  void offer(ros::NodeHandle& node, const std::string& name, std::function<control::Answer()> command);
  /// What moves the robot. `command` gets ControlSystem::wishesSoFar() of when the request came in.
  void offerMotion(ros::NodeHandle& node, const std::string& name, std::function<control::Answer(Stops)> command);
  template <typename Event>
  bool reply(Event& call, const std::string& what, const control::Answer& answer);

  control::ControlSystem& system_;
  References& references_;
  const Folder& patients_;
  const Folder& recordings_;
  EventLog& log_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace knee_robot::nodes
