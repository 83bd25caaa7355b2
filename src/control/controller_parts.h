#pragma once

#include <atomic>
#include <memory>

#include "black_box_writer.h"
#include "chores.h"
#include "cycle_runner.h"
#include "fault_recovery.h"
#include "feedforward_setup.h"
#include "heat_memory.h"
#include "knee_robot/control/control_system.h"
#include "live_properties.h"
#include "machine_components.h"
#include "machine_report.h"
#include "machine_requests.h"
#include "occupancy_record.h"
#include "operator_panel.h"
#include "path_player.h"
#include "patient_checklist.h"
#include "recordings.h"

namespace knee_robot::control {

/// What a ControlSystem is put together from, each part with what it needs of those before it. Taken apart in reverse:
/// what uses a component ends before the components.
struct ControllerParts {
  /// Reads the deployment, makes and connects everything; nothing runs. Throws InputError. `bus` must outlive this.
  ControllerParts(const mechanism::Robot& given_robot, const HardwareFile& given_hardware,
                  const std::string& deployment_path, hardware::AxisBus& given_bus,
                  ControlSystem::Options given_options);

  /// The facts about this machine as it is now.
  PatientChecklist checklist() const;

  const mechanism::Robot robot;
  const HardwareFile hardware;
  const ControlSystem::Options options;
  hardware::AxisBus& bus;
  const std::unique_ptr<rt::Deployment> deployment;
  const bool threaded = options.execution == rt::Execution::Threads;
  std::atomic<bool> started{false};
  const MachineComponents machine{*deployment};
  const FeedforwardSetup feedforward{*deployment, machine, robot, options.model, options.payload_kg};
  OperatorPanel panel{machine};
  const MachineReport report{*deployment, machine, panel, bus, started};
  // Incremental encoders know their place anew at every start. Stepped runs are to be the same whenever they are made.
  Recordings recordings{machine, robot.axes(), threaded, threaded ? static_cast<std::int64_t>(std::time(nullptr)) : 0};
  BlackBoxWriter black_box{*machine.black_box, options.black_box_folder, threaded};
  CycleRunner runner{*deployment, [this] {
                       recordings.drain();
                       black_box.write();
                     }};
  MachineRequests requests{machine, hardware, panel, report, runner, started};
  FaultRecovery recovery{*deployment, bus, report, requests, runner};
  LiveProperties properties{*deployment, feedforward};
  PathPlayer player{robot, *machine.sync, panel, requests};
  OccupancyRecord occupancy{PatientMemory(options.patient_memory), [this] { return whyOccupancyStays(); },
                            [this](Occupancy now, const PatientRange& range) { tellOccupancy(now, range); }};
  HeatMemory heat{options.heat_file};
  const Chores chores{threaded, {[this] { occupancy.keep(); }, [this] { heat.write(); }}};

 private:
  std::string whyOccupancyStays() const;
  void tellOccupancy(Occupancy now, const PatientRange& range);
};

}  // namespace knee_robot::control
