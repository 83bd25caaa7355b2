#pragma once

#include <memory>
#include <string>

#include "disturbance_classifier.h"
#include "homing_turn.h"
#include "knee_robot/control/axis_data.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"
#include "pulse_witness.h"
#include "residual_estimator.h"
#include "rest_turn.h"
#include "rest_watch.h"

namespace knee_robot::control {

/// Says what acts on the robot that nobody commanded.
///
/// - Suspicion: RestWatch sees the standing robot disturbed; the Drivers ask their encoders then. Where nothing counts
///   at all, RestTurn has one of them asked now and then.
/// - Felt: PulseWitness tells an axis that moves unseen from one that does not move at all.
/// - Residual: ResidualEstimator compares the written force with that of the model; DisturbanceClassifier tells a load,
///   a push, friction and a model that does not hold apart. The model is ModelFeedforward's (useModel()), its payload
///   the declared one; without a model file the weights of the URDF, and nothing is evaluated.
/// Runs between AxesInput and the Drivers; commands and outputs are those of the last cycle. No allocation, no lock,
/// bounded time.
class DisturbanceObserver : public rt::TaskContext {
 public:
  DisturbanceObserver(const std::string& name, const mechanism::Robot& robot);

  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<SupervisorCommand> orders{*this, "orders", "from the Supervisor"};
  rt::InputPort<AxesWritten> written{*this, "written", "from AxesOutput, of the last cycle"};
  rt::InputPort<AxisCommand> command_1{*this, "command_1", "from the Driver of axis 1"};
  rt::InputPort<AxisCommand> command_2{*this, "command_2", "from the Driver of axis 2"};
  rt::InputPort<AxisCommand> command_3{*this, "command_3", "from the Driver of axis 3"};
  rt::InputPort<AxisCommand> command_4{*this, "command_4", "from the Driver of axis 4"};
  rt::InputPort<FeedforwardForce> feedforward{*this, "feedforward", "declared payload, from ModelFeedforward",
                                              rt::Need::Optional};
  rt::OutputPort<Disturbance> disturbance{*this, "disturbance", "to Drivers, Monitors and Recorder"};

  rt::Property<std::string> model{*this, "model", "", "model file of this robot; empty: the weights of its URDF"};

  rt::Property<double> rest_question{*this,
                                     "rest_question_s",
                                     30.0,
                                     "s",
                                     0.0,
                                     600.0,
                                     "when no axis has counted for this time at rest, one gets a test pulse; 0: none"};

  /// Ordinary thread, before configure(): reads the model. InputError names the file and the reason. configure() does
  /// it otherwise.
  void loadModel();

 protected:
  bool configureHook() override;
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  void readPorts() noexcept;
  bool rests() const noexcept;
  bool carries() const noexcept;
  void watchRest(double dt) noexcept;
  void estimate(double dt) noexcept;

  const mechanism::Robot robot_;
  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> inputs_;
  AxesMeasurement measured_;
  bool new_reading_ = false;
  SupervisorCommand order_;
  AxesWritten written_;
  std::array<AxisCommand, hardware::kAxes> commands_{};
  std::unique_ptr<const ForceKnowledge> knowledge_;
  FeedforwardForce model_force_;
  ResidualEstimator residual_;
  DisturbanceClassifier classifier_;
  RestWatch rest_;
  RestTurn turn_;
  HomingTurn homing_turn_;
  std::array<PulseWitness, hardware::kAxes> witness_;
  RestWatch::Axes count_m_{};
  rt::Nanoseconds last_time_ = 0;
  Disturbance out_;
};

}  // namespace knee_robot::control
