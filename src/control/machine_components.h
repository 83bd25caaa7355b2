#pragma once

#include <vector>

#include "axes_input.h"
#include "axes_output.h"
#include "black_box.h"
#include "disturbance_observer.h"
#include "hand_guide.h"
#include "knee_robot/control/driver.h"
#include "knee_robot/control/model_feedforward.h"
#include "knee_robot/rt/deployer.h"
#include "monitors.h"
#include "recorder.h"
#include "supervisor.h"
#include "sync.h"

namespace knee_robot::control {

/// The components of a deployment that make a controller: one of each, a Driver an axis, in an order in which one cycle
/// of one thread reads, decides and writes. Pointers into the deployment, which must outlive this.
struct MachineComponents {
  /// InputError names the deployment file and what it lacks.
  explicit MachineComponents(const rt::Deployment& deployment);

  Sync* sync;
  Recorder* recorder;
  Supervisor* supervisor;
  AxesInput* input;
  AxesOutput* output;
  Monitors* monitors;
  BlackBox* black_box;
  ModelFeedforward* feedforward;  ///< may be missing
  DisturbanceObserver* observer;  ///< may be missing
  HandGuide* guide;               ///< may be missing
  std::vector<Driver*> drivers;   ///< as in the file

 private:
  void checkDrivers(const rt::Deployment& deployment) const;
  void checkOrder(const rt::Deployment& deployment) const;
};

}  // namespace knee_robot::control
