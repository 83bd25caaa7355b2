#pragma once

#include <string>

#include "knee_robot/hardware/can/frame.h"

namespace knee_robot::hardware::can {

/// What an error frame of the kernel tells (linux/can/error.h).
struct BusErrors {
  bool bus_off = false;        ///< the controller has left the bus; it sends and receives nothing until it is restarted
  bool restarted = false;      ///< it is back on the bus
  bool error_passive = false;  ///< many errors: the next step is bus-off
  bool error_warning = false;
  bool overflow = false;          ///< frames were lost in the controller's queues
  bool not_acknowledged = false;  ///< nobody else is on the bus: cable, other nodes without power, wrong bit rate
  bool protocol = false;          ///< bit errors: termination, wrong bit rate, noise
  bool lost_arbitration = false;
  bool timeout = false;  ///< the controller's transmit timeout
};

/// Any frame may be given; one that is no error frame tells nothing.
BusErrors busErrors(const Frame& frame) noexcept;
/// Not real-time: "bus-off, nobody acknowledges"; "no error" when there is none.
std::string toText(const BusErrors& errors);

}  // namespace knee_robot::hardware::can
