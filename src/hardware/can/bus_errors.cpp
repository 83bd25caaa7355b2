#include "bus_errors.h"

#include <linux/can.h>
#include <linux/can/error.h>

namespace knee_robot::hardware::can {

BusErrors busErrors(const Frame& frame) noexcept {
  BusErrors errors;
  if (!frame.error) return errors;
  const auto has = [&](std::uint32_t bit) { return (frame.id & bit) != 0; };
  errors.bus_off = has(CAN_ERR_BUSOFF);
  errors.restarted = has(CAN_ERR_RESTARTED);
  errors.not_acknowledged = has(CAN_ERR_ACK);
  errors.protocol = has(CAN_ERR_PROT | CAN_ERR_BUSERROR);
  errors.lost_arbitration = has(CAN_ERR_LOSTARB);
  errors.timeout = has(CAN_ERR_TX_TIMEOUT);
  if (has(CAN_ERR_CRTL)) {
    const unsigned detail = frame.data[1];
    errors.overflow = (detail & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0;
    errors.error_warning = (detail & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0;
    errors.error_passive = (detail & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0;
  }
  return errors;
}

std::string toText(const BusErrors& errors) {
  std::string text;
  const auto add = [&](bool there, const char* what) {
    if (there) text += (text.empty() ? "" : ", ") + std::string(what);
  };
  add(errors.bus_off, "bus-off");
  add(errors.restarted, "restarted after bus-off");
  add(errors.error_passive, "error passive");
  add(errors.error_warning, "error warning");
  add(errors.overflow, "frames lost in the controller");
  add(errors.not_acknowledged, "nobody acknowledges");
  add(errors.protocol, "bit errors");
  add(errors.lost_arbitration, "arbitration lost");
  add(errors.timeout, "transmit timeout");
  return text.empty() ? "no error" : text;
}

}  // namespace knee_robot::hardware::can
