#include "drive_setup.h"

#include <cmath>
#include <cstdio>

#include "knee_robot/hardware/can/canopen.h"
#include "knee_robot/hardware/can/cia402.h"

namespace knee_robot::hardware::can {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kBootPatience = 2000 * kMillisecond;
constexpr std::int64_t kStatePatience = 1000 * kMillisecond;
constexpr double kLimitTolerance = 0.01;

DriveState stateNow(SdoClient& drive) {
  return stateOf(drive.read<std::uint16_t>(objects::kStatusWord));
}

template <typename Wanted>
bool awaitState(FramePort& port, SdoClient& drive, Wanted&& wanted) {
  const std::int64_t end = port.now() + kStatePatience;
  while (!wanted(stateNow(drive))) {
    if (port.now() > end) return false;
    port.pause(kMillisecond);
  }
  return true;
}

[[noreturn]] void refuse(const SdoClient& drive, const std::string& what) {
  throw SdoError("node " + std::to_string(drive.node()) + ": " + what, 0);
}

/// A drive that a crash has left enabled stops on its own ramp before its power stage is switched off.
void bringDown(FramePort& port, SdoClient& drive) {
  if (stateNow(drive) == DriveState::OperationEnabled) {
    drive.write<std::uint16_t>(objects::kControlWord, kQuickStop);
    awaitState(port, drive,
               [](DriveState s) { return s != DriveState::OperationEnabled && s != DriveState::QuickStopActive; });
  }
  drive.write<std::uint16_t>(objects::kControlWord, kDisableVoltage);
  const auto off = [](DriveState s) { return s != DriveState::OperationEnabled && s != DriveState::SwitchedOn; };
  if (!awaitState(port, drive, off)) refuse(drive, "its power stage cannot be switched off");
  drive.write<std::int16_t>(objects::kTargetTorque, 0);
  drive.write<std::uint32_t>(objects::kDigitalOutputs, 0);
}

/// Communication as after power-up: nothing of an earlier configuration is left.
void resetCommunication(FramePort& port, const SdoClient& drive) {
  if (port.send(nmtFrame(NmtCommand::ResetCommunication, drive.node())) != PortStatus::Ok) {
    refuse(drive, "the bus takes no frame: is it up?");
  }
  const std::int64_t end = port.now() + kBootPatience;
  while (port.now() < end) {
    Frame frame;
    const PortStatus status = port.receive(frame);
    if (status == PortStatus::Down) refuse(drive, "the interface went down");
    if (status == PortStatus::Empty) port.pause(kMillisecond);
    if (status != PortStatus::Ok) continue;
    const auto beat = parseHeartbeat(frame);
    if (beat && beat->node == drive.node() && beat->state == NmtState::BootUp) return;
  }
  refuse(drive, "does not boot after a reset of its communication");
}

void verifyIdentity(SdoClient& drive, const CanSettings& settings, const DriveSettings& wanted) {
  const auto require = [&](const char* what, std::uint32_t found, std::uint32_t expected) {
    if (found == expected) return;
    refuse(drive, std::string("wrong identity: ") + what + " " + std::to_string(found) + " instead of " +
                      std::to_string(expected));
  };
  require("device profile", drive.read<std::uint32_t>(objects::kDeviceType) & 0xFFFF, objects::kDriveDeviceType);
  require("vendor", drive.read<std::uint32_t>(objects::kVendor), settings.vendor);
  require("product", drive.read<std::uint32_t>(objects::kProduct), settings.product);
  if (wanted.serial) require("serial number", drive.read<std::uint32_t>(objects::kSerial), *wanted.serial);
}

/// The limits are set with the maker's tool and only compared here: a program that raises them would take their meaning
/// away.
void verifyLimits(SdoClient& drive, const DriveSettings& wanted) {
  const auto require = [&](const char* what, objects::Object object, double scale, double expected) {
    const double found = scale * drive.read<std::uint32_t>(object);
    if (std::abs(found - expected) <= kLimitTolerance * expected) return;
    char text[160];
    std::snprintf(text, sizeof text, "%s (%s) is %g in the drive and %g in the hardware file; mend the wrong one", what,
                  objectName(object).c_str(), found, expected);
    refuse(drive, text);
  };
  require("rated torque in Nm", objects::kRatedTorque, 1e-6, wanted.rated_torque_Nm);
  require("nominal current in A", objects::kNominalCurrent, 1e-3, wanted.nominal_current_A);
  require("current limit in A", objects::kCurrentLimit, 1e-3, wanted.current_limit_A);
}

void configureDrive(SdoClient& drive, const CanSettings& settings, bool with_inputs) {
  drive.write<std::int8_t>(objects::kMode, objects::kCyclicTorque);
  if (drive.read<std::int8_t>(objects::kModeDisplay) != objects::kCyclicTorque) {
    refuse(drive, "does not enter cyclic synchronous torque (6061)");
  }
  drive.writeChecked<std::int8_t>(objects::kPeriodExponent, -3);
  drive.writeChecked<std::uint8_t>(objects::kPeriod, static_cast<std::uint8_t>(std::lround(settings.period_s * 1e3)));
  drive.writeChecked<std::int16_t>(objects::kAbortConnection, objects::kQuickStopOnLoss);
  drive.writeChecked<std::int16_t>(objects::kQuickStopOption, 2);  // ramp, then power stage off
  const int node = drive.node();
  for (const Pdo& pdo : {commandPdo(node), outputsPdo(node), feedbackPdo(node)})
    configure(drive, pdo);
  if (with_inputs) configure(drive, inputsPdo(node));
  if (!with_inputs) disable(drive, true, inputsPdo(node).number, inputsPdo(node).id);
  for (int number = 2; number < 4; ++number) {
    const std::uint32_t step = static_cast<std::uint32_t>(0x100 * number + node);
    disable(drive, false, number, kReceivePdoBase + step);
    disable(drive, true, number, kTransmitPdoBase + step);
  }
  const double beat_ms = 1e3 * settings.heartbeat_s;
  drive.writeChecked<std::uint16_t>(objects::kProducerHeartbeat, static_cast<std::uint16_t>(std::lround(beat_ms)));
  const std::uint32_t patience = static_cast<std::uint32_t>(std::lround(2.5 * beat_ms));
  drive.writeChecked<std::uint32_t>(objects::kConsumerHeartbeat,
                                    static_cast<std::uint32_t>(settings.controller_node) << 16 | patience);
}

void resetFault(FramePort& port, SdoClient& drive) {
  if (stateNow(drive) != DriveState::Fault) return;
  const auto code = drive.read<std::uint16_t>(objects::kErrorCode);
  drive.write<std::uint16_t>(objects::kControlWord, kDisableVoltage);
  drive.write<std::uint16_t>(objects::kControlWord, kFaultReset);
  const bool gone = awaitState(port, drive, [](DriveState s) { return s != DriveState::Fault; });
  drive.write<std::uint16_t>(objects::kControlWord, kDisableVoltage);
  if (!gone) refuse(drive, std::string("stays in fault: ") + emergencyText(code) + " (" + std::to_string(code) + ")");
}

}  // namespace

Pdo commandPdo(int node) {
  return {false,
          0,
          kReceivePdoBase + static_cast<std::uint32_t>(node),
          1,
          {{objects::kControlWord, 16}, {objects::kTargetTorque, 16}}};
}
Pdo outputsPdo(int node) {
  return {false, 1, kReceivePdoBase + 0x100 + static_cast<std::uint32_t>(node), 255, {{objects::kDigitalOutputs, 32}}};
}
Pdo feedbackPdo(int node) {
  return {true,
          0,
          kTransmitPdoBase + static_cast<std::uint32_t>(node),
          1,
          {{objects::kStatusWord, 16}, {objects::kPosition, 32}, {objects::kTorque, 16}}};
}
Pdo inputsPdo(int node) {
  return {true, 1, kTransmitPdoBase + 0x100 + static_cast<std::uint32_t>(node), 1, {{objects::kDigitalInputs, 32}}};
}

bool setUpDrive(FramePort& service, const CanSettings& settings, std::size_t axis, std::vector<std::string>& findings) {
  const DriveSettings& wanted = settings.drives[axis];
  SdoClient drive(service, wanted.node);
  try {
    bringDown(service, drive);
    resetCommunication(service, drive);
    verifyIdentity(drive, settings, wanted);
    verifyLimits(drive, wanted);
    configureDrive(drive, settings, axis == 0);
    resetFault(service, drive);
    if (service.send(nmtFrame(NmtCommand::Start, wanted.node)) != PortStatus::Ok) refuse(drive, "cannot be started");
  } catch (const SdoError& error) {
    findings.push_back("axis " + std::to_string(axis + 1) + ": " + error.what() + ".");
    return false;
  }
  findings.push_back("axis " + std::to_string(axis + 1) + ": node " + std::to_string(wanted.node) +
                     ": identity and limits as described, cyclic torque, PDOs read back.");
  return true;
}

}  // namespace knee_robot::hardware::can
