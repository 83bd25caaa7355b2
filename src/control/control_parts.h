#pragma once

#include <string>
#include <vector>

#include "knee_robot/control/axes_input.h"
#include "knee_robot/control/axes_output.h"
#include "knee_robot/control/black_box_writer.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/control/disturbance_observer.h"
#include "knee_robot/control/driver.h"
#include "knee_robot/control/hand_guide.h"
#include "knee_robot/control/heat_memory.h"
#include "knee_robot/control/model_feedforward.h"
#include "knee_robot/control/monitors.h"
#include "knee_robot/control/recorder.h"
#include "knee_robot/control/recording_drain.h"
#include "knee_robot/control/supervisor.h"
#include "knee_robot/control/sync.h"

namespace knee_robot::control {

/// The operator's end of the ports: a component that no activity executes.
class OperatorPanel : public rt::TaskContext {
 public:
  OperatorPanel() : rt::TaskContext("Operator") {}
  rt::OutputPort<Request> request{*this, "request", "to the Supervisor"};
  rt::InputPort<SupervisorStatus> status{*this, "status", "from the Supervisor"};
  rt::InputPort<TrackingRow> row{*this, "row", "from the Recorder"};
  rt::InputPort<MonitorVerdict> verdict{*this, "verdict", "from Monitors"};
  rt::InputPort<Disturbance> disturbance{*this, "disturbance", "from the DisturbanceObserver", rt::Need::Optional};
};

/// What a ControlSystem knows of the components of its deployment.
struct ControlSystem::Parts {
  /// Finds the components and checks that they can work together; InputError names the deployment file.
  explicit Parts(const rt::Deployment& deployment);
  /// The operator's model and payload in place of the deployment's; reads the model.
  void prepareFeedforward(const rt::Deployment& deployment, const mechanism::Robot& robot, const Options& options);
  /// The passivity-based law is passive with certain gains only: a sentence, or empty. `changed`: a Driver's property as it would be.
  std::string whyNotPassive(const Driver& driver, const std::string& changed = "", double value = 0.0) const;
  /// Where Sync would let the loaded reference begin. Under the system's mutex.
  bool standsAtStart();

  Sync* sync = nullptr;
  Recorder* recorder = nullptr;
  Supervisor* supervisor = nullptr;
  AxesInput* input = nullptr;
  AxesOutput* output = nullptr;
  Monitors* monitors = nullptr;
  BlackBox* black_box = nullptr;
  ModelFeedforward* feedforward = nullptr;  // may be missing
  DisturbanceObserver* observer = nullptr;  // may be missing
  HandGuide* guide = nullptr;               // may be missing
  OperatorPanel panel;
  std::unique_ptr<RecordingDrain> drain;
  std::unique_ptr<BlackBoxWriter> black_box_writer;
  std::unique_ptr<HeatMemory> heat_memory;
  std::string heat_refused;  // why the motors count as hot
  Occupancy occupancy = Occupancy::Unknown;
  std::optional<PatientLimits> patient;
  PatientMemory patient_memory{""};
  std::string patient_refused;                 // why the patient of the last run is not loaded
  std::vector<rt::PropertyReport> at_loading;  // properties when the patient was loaded
  bool changing_occupancy = false;             // somebody is saying who is on the robot: nothing is enabled
  int powering = 0;                            // requests under way that switch the drives on
  std::uint32_t requests = 0;
  std::string reference_name;
  std::string playing;           // what was played last
  trajectory::Points reference;  // empty: none
  int steps = 0;

 private:
  void checkOrder(const rt::Deployment& deployment) const;
  void checkLaw(const rt::Deployment& deployment) const;
  void checkDelays(const rt::Deployment& deployment, const mechanism::Robot& robot) const;
};

}  // namespace knee_robot::control
