#pragma once

#include "fake_machine.h"
#include "src/control/supervisor_view.h"

namespace knee_robot::fake {

/// A machine that is well: measured, evaluated, drives at `level`, all Drivers carrying.
inline control::SupervisorView wellView(control::DriveLevel level = control::DriveLevel::Off) {
  control::SupervisorView view;
  view.measured.sequence = view.written.sequence = 1;
  view.measured.status = view.written.status = hardware::IoStatus::Ok;
  view.measured.position_m.fill(kHome);
  view.measured.digital_inputs = 0x0f;
  view.written.level = level;
  for (int i = 0; i < 4; ++i) {
    view.commands[static_cast<std::size_t>(i)].axis = i + 1;
    view.commands[static_cast<std::size_t>(i)].active = true;
  }
  return view;
}

}  // namespace knee_robot::fake
