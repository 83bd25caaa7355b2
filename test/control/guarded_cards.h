#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include "knee_robot/control/guardian.h"
#include "knee_robot/hardware/guarded_bus.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "test/control/milliseconds.h"

namespace knee_robot::control::guarded {

using hardware::IoStatus;

inline rt::Nanoseconds& testTime() {
  static rt::Nanoseconds time = 0;
  return time;
}
inline rt::Nanoseconds testClock() noexcept {
  return testTime();
}

/// Guardian and guarded controller on one pair of card models; no thread, the test's clock.
class GuardedCards : public ::testing::Test {
 protected:
  GuardedCards() {
    testTime() = 0;
    guardian_.configure();
    guardian_.start();
    // What selfTest() does, without waiting for a guardian that runs beside it.
    link_.controller_pid.store(::getpid());
    EXPECT_TRUE(cards_->selfTest().passed);
  }
  void cycle() {
    testTime() += kMs;
    guardian_.update({testTime(), testTime(), kMs});
  }
  IoStatus hold(double volts = 3.0) {
    hardware::IoStatus status = bus_.writeVolts({volts, volts, volts, volts}, written_);
    heartbeat_ ^= 4;
    const IoStatus outputs = bus_.writeOutputs(heartbeat_ | 3);  // drives enabled, holding brakes released
    return status == IoStatus::Ok ? outputs : status;
  }
  double volts(std::size_t channel) const { return simulation::outputVolts(image_.analog)[channel]; }

  simulation::RobotImage image_;
  hardware::GuardianLink link_;
  std::unique_ptr<hardware::AxisBus> cards_ = simulation::openImageCards(image_);
  std::unique_ptr<hardware::EmergencyOutputs> outputs_ = simulation::openImageEmergencyOutputs(image_);
  hardware::GuardedBus bus_{*cards_, link_, 3};
  Guardian guardian_{link_, *outputs_, 10 * kMs, kMs, testClock};
  std::array<double, hardware::kAxes> written_{};
  std::uint8_t heartbeat_ = 0;
};

}  // namespace knee_robot::control::guarded
