#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "fake_machine.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/control/driver.h"
#include "knee_robot/control/model_feedforward.h"
#include "src/control/axes_input.h"
#include "src/control/axes_output.h"
#include "src/control/black_box.h"
#include "src/control/disturbance_observer.h"
#include "src/control/hand_guide.h"
#include "src/control/monitors.h"
#include "src/control/recorder.h"
#include "src/control/supervisor.h"
#include "src/control/sync.h"

namespace knee_robot::fake {

/// What is done to components by name, before and in their updateHook.
struct Injection {
  std::string throws;                                                // component whose updateHook throws
  std::string silent;                                                // component whose updateHook does nothing
  std::string fatal;                                                 // component that declares itself dead
  std::function<void(const std::string& name, bool begins)> around;  // every update
  std::map<std::string, int> stops;                                  // stop hooks that ran
};

/// A component with an Injection around its hooks.
template <typename Base>
class Faulty : public Base {
 public:
  template <typename... Arguments>
  Faulty(Injection& injection, Arguments&&... arguments)
      : Base(std::forward<Arguments>(arguments)...), injection_(injection) {}

 protected:
  void updateHook(const rt::Cycle& cycle) override {
    if (injection_.throws == this->name()) throw std::runtime_error("injected");
    if (injection_.fatal == this->name()) return this->fatal("injected");
    if (injection_.silent == this->name()) return;
    if (injection_.around) injection_.around(this->name(), true);
    Base::updateHook(cycle);
    if (injection_.around) injection_.around(this->name(), false);
  }
  void stopHook() override {
    ++injection_.stops[this->name()];
    Base::stopHook();
  }

 private:
  Injection& injection_;
};

inline rt::TypeFactory faultyTypes(Injection& injection, Machine& machine, const control::HardwareFile& h) {
  using Name = const std::string&;
  const mechanism::Robot r = robot();
  const control::AxisValues lengths{kHome, kHome, kHome, kHome};
  return {
      {"AxesInput",
       [=, &injection, &machine](Name n) {
         return std::make_unique<Faulty<control::AxesInput>>(injection, n, r, machine, lengths);
       }},
      {"Sync", [=, &injection](Name n) { return std::make_unique<Faulty<control::Sync>>(injection, n, r); }},
      {"Driver", [=, &injection](Name n) { return std::make_unique<Faulty<control::Driver>>(injection, n, r, h); }},
      {"ModelFeedforward",
       [=, &injection](Name n) { return std::make_unique<Faulty<control::ModelFeedforward>>(injection, n, r); }},
      {"DisturbanceObserver",
       [=, &injection](Name n) { return std::make_unique<Faulty<control::DisturbanceObserver>>(injection, n, r); }},
      {"HandGuide", [=, &injection](Name n) { return std::make_unique<Faulty<control::HandGuide>>(injection, n, r); }},
      {"Monitors", [=, &injection](Name n) { return std::make_unique<Faulty<control::Monitors>>(injection, n, r); }},
      {"BlackBox", [=, &injection](Name n) { return std::make_unique<Faulty<control::BlackBox>>(injection, n); }},
      {"Supervisor",
       [=, &injection](Name n) { return std::make_unique<Faulty<control::Supervisor>>(injection, n, r, h); }},
      {"AxesOutput",
       [=, &injection, &machine](Name n) {
         return std::make_unique<Faulty<control::AxesOutput>>(injection, n, r, h, machine);
       }},
      {"Recorder", [=, &injection](Name n) { return std::make_unique<Faulty<control::Recorder>>(injection, n); }},
  };
}

inline std::string deploymentFile() {
  return std::string(KNEE_SOURCE_DIR) + "/config/deployment/simulation.yaml";
}

/// The whole controller, stepped, on the fake machine.
struct Rig {
  explicit Rig(control::HardwareFile hardware_file = hardware(), const std::string& black_box_folder = "",
               const std::string& heat_file = "")
      : machine(robot()),
        system(robot(), hardware_file, deploymentFile(), machine, options(hardware_file, black_box_folder, heat_file)) {
    system.setPlant([this](rt::Nanoseconds time) { machine.advanceTo(rt::toSeconds(time)); });
  }
  control::ControlSystem::Options options(const control::HardwareFile& hardware_file,
                                          const std::string& black_box_folder, const std::string& heat_file) {
    control::ControlSystem::Options all;
    all.heat_file = heat_file;
    all.black_box_folder = black_box_folder;
    all.execution = rt::Execution::Stepped;
    all.empty = true;
    all.types = faultyTypes(injection, machine, hardware_file);
    return all;
  }
  /// Holding at home.
  void hold() {
    ASSERT_TRUE(system.start().ok);
    const control::Answer answer = system.enable();
    ASSERT_TRUE(answer.ok) << answer.sentence;
    system.run(2.0);
    ASSERT_EQ(system.state(), control::MachineState::Holding);
  }
  /// In the middle of a motion of 30 mm in 2 s.
  void play() {
    hold();
    const control::Answer loaded = system.loadReference(smoothReference(kHome, 0.03, 2.0));
    ASSERT_TRUE(loaded.ok) << loaded.sentence;
    const control::Answer played = system.play();
    ASSERT_TRUE(played.ok) << played.sentence;
    system.run(1.0);
    ASSERT_EQ(system.state(), control::MachineState::Playing);
  }
  double lowest() const {
    double low = 1.0;
    for (const Machine::Axis& axis : machine.axes)
      low = std::min(low, axis.position);
    return low;
  }

  Machine machine;
  Injection injection;
  control::ControlSystem system;
};

}  // namespace knee_robot::fake
