#pragma once

#include <cstdint>

/// Objects of CANopen (CiA 301) and of drives (CiA 402) that are used here, as EPOS4-class drives have them. From
/// public documentation; not verified on a drive by this project. Absent on EPOS4 and therefore not used: 1006, 1015,
/// 1029, 605D, 6072, 6075.
namespace knee_robot::hardware::can::objects {

/// Index in bits 23..8, subindex in bits 7..0, as PDO mappings have it.
using Object = std::uint32_t;
constexpr Object object(std::uint16_t index, std::uint8_t subindex = 0) noexcept {
  return static_cast<Object>(index) << 8 | subindex;
}
constexpr std::uint16_t indexOf(Object object) noexcept {
  return static_cast<std::uint16_t>(object >> 8);
}
constexpr std::uint8_t subindexOf(Object object) noexcept {
  return static_cast<std::uint8_t>(object);
}

inline constexpr Object kDeviceType = object(0x1000);
inline constexpr Object kErrorRegister = object(0x1001);
inline constexpr Object kConsumerHeartbeat = object(0x1016, 1);  ///< node << 16 | ms; default 0: off
inline constexpr Object kProducerHeartbeat = object(0x1017);     ///< ms; default 0: off
inline constexpr Object kVendor = object(0x1018, 1);
inline constexpr Object kProduct = object(0x1018, 2);
inline constexpr Object kSerial = object(0x1018, 4);
inline constexpr std::uint16_t kReceivePdo = 0x1400;  ///< + n: communication; 0x1600 + n: mapping
inline constexpr std::uint16_t kReceivePdoMapping = 0x1600;
inline constexpr std::uint16_t kTransmitPdo = 0x1800;  ///< + n: communication; 0x1A00 + n: mapping
inline constexpr std::uint16_t kTransmitPdoMapping = 0x1A00;

inline constexpr Object kNominalCurrent = object(0x3001, 1);  ///< mA, thermal limit in the drive
inline constexpr Object kCurrentLimit = object(0x3001, 2);    ///< mA, peak
inline constexpr Object kAbortConnection = object(0x6007);    ///< 3: quick stop when the connection is lost
inline constexpr Object kErrorCode = object(0x603F);
inline constexpr Object kControlWord = object(0x6040);
inline constexpr Object kStatusWord = object(0x6041);
inline constexpr Object kQuickStopOption = object(0x605A);
inline constexpr Object kMode = object(0x6060);
inline constexpr Object kModeDisplay = object(0x6061);
inline constexpr Object kPosition = object(0x6064);  ///< counts
inline constexpr Object kVelocity = object(0x606C);
inline constexpr Object kTargetTorque = object(0x6071);       ///< per mille of kRatedTorque
inline constexpr Object kRatedTorque = object(0x6076);        ///< micro-Nm
inline constexpr Object kTorque = object(0x6077);             ///< per mille of kRatedTorque
inline constexpr Object kPeriod = object(0x60C2, 1);          ///< interpolation time; default 0
inline constexpr Object kPeriodExponent = object(0x60C2, 2);  ///< default -3: ms
inline constexpr Object kDigitalInputs = object(0x60FD);
inline constexpr Object kDigitalOutputs = object(0x60FE, 1);

inline constexpr std::uint32_t kDriveDeviceType = 402;  ///< low 16 bits of 1000
inline constexpr std::int8_t kCyclicTorque = 10;        ///< mode: cyclic synchronous torque
inline constexpr std::int16_t kQuickStopOnLoss = 3;
/// 60FD and 60FE: the maker's lines begin at bit 16.
inline constexpr int kFirstLine = 16;

}  // namespace knee_robot::hardware::can::objects
