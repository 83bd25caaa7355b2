#pragma once

#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/deployer.h"

namespace knee_robot::control {

/// The component types that a deployment file may name: AxesInput, Sync, Driver, Monitors, Supervisor,
/// AxesOutput, Recorder, BlackBox. `bus` must
/// outlive the components; robot and hardware are copied.
rt::TypeFactory componentTypes(const mechanism::Robot& robot, const HardwareFile& hardware, hardware::AxisBus& bus,
                               const AxisValues& lengths_at_start);

}  // namespace knee_robot::control
