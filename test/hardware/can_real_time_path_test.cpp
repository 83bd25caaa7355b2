// The cyclic path on SEQPACKET socket pairs: nothing allocates, nothing waits, and it works with real sockets between.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "knee_robot/hardware/can/can_axis_bus.h"
#include "test/allocation_guard.h"
#include "test/hardware/can_bench.h"

namespace knee_robot::hardware::can {
namespace {

/// Two socket pairs as one bus: the controller's process and service ports at one side, four drives at the other.
class PairedBus {
 public:
  PairedBus() : settings_(benchSettings()) {
    for (std::size_t i = 0; i < 2; ++i) {
      int ends[2];
      if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends) != 0) std::abort();
      near_[i].socket = CanSocket::adopt(ends[0], i == 0 ? processFilters(settings_) : serviceFilters(settings_));
      near_[i].owner = this;
      far_[i] = CanSocket::adopt(ends[1], {});
    }
    drives_port_.owner = this;
    for (std::size_t i = 0; i < drives_.size(); ++i)
      drives_[i] = std::make_unique<simulation::DriveModel>(settings_.drives[i].node, driveTable(), drives_port_);
    bus_ = std::make_unique<CanAxisBus>(near_[0], near_[1], settings_, benchUnits());
  }

  CanAxisBus& bus() { return *bus_; }
  simulation::DriveModel& drive(std::size_t axis) { return *drives_.at(axis); }
  /// Lets the drives take what was sent, and act on it.
  void pump() {
    now_ += 2'000'000;
    for (const auto& end : far_) {
      Frame frame;
      while (end->receive(frame) == PortStatus::Ok) {
        for (const auto& drive : drives_)
          drive->take(frame);
      }
    }
    for (const auto& drive : drives_)
      drive->step(now_);
  }
  void closeFarEnd() { far_ = {}; }

 private:
  struct Near : FramePort {
    PortStatus send(const Frame& frame) noexcept override { return socket->send(frame); }
    PortStatus receive(Frame& frame) noexcept override {
      const PortStatus status = socket->receive(frame);
      if (status == PortStatus::Ok) frame.received_ns = owner->now_;
      return status;
    }
    std::int64_t now() noexcept override { return owner->now_; }
    void pause(std::int64_t) override { owner->pump(); }
    std::unique_ptr<CanSocket> socket;
    PairedBus* owner = nullptr;
  };
  struct OfDrives : FramePort {
    PortStatus send(const Frame& frame) noexcept override {
      for (const auto& end : owner->far_)
        if (end) end->send(frame);
      return PortStatus::Ok;
    }
    PortStatus receive(Frame&) noexcept override { return PortStatus::Empty; }
    std::int64_t now() noexcept override { return owner->now_; }
    void pause(std::int64_t) override {}
    PairedBus* owner = nullptr;
  };

  CanSettings settings_;
  std::int64_t now_ = 1'000'000'000;
  std::array<Near, 2> near_;
  std::array<std::unique_ptr<CanSocket>, 2> far_;
  OfDrives drives_port_;
  std::array<std::unique_ptr<simulation::DriveModel>, kAxes> drives_;
  std::unique_ptr<CanAxisBus> bus_;
};

TEST(CanRealTimePath, EnablesDrivesAndMovesTorqueWithoutAllocating) {
  PairedBus pair;
  const SelfTest test = pair.bus().selfTest();
  ASSERT_TRUE(test.passed) << test.findings.back();
  allocations = 0;
  AxisFeedback feedback;
  std::array<double, kAxes> written{};
  for (int cycle = 0; cycle < 200; ++cycle) {
    pair.pump();
    pair.drive(0).setPosition(cycle);
    armed = true;
    const IoStatus read = pair.bus().read(feedback);
    const IoStatus volts = pair.bus().writeVolts({1.0, -1.0, 2.0, -2.0}, written);
    const IoStatus outputs = pair.bus().writeOutputs(static_cast<std::uint8_t>(1 | (cycle & 1) << 2));
    armed = false;
    ASSERT_EQ(read, IoStatus::Ok);
    ASSERT_EQ(volts, IoStatus::Ok);
    ASSERT_EQ(outputs, IoStatus::Ok);
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_EQ(pair.bus().failure().fault, BusFault::None);
  EXPECT_EQ(feedback.counts[0], 198) << "one period old";
  for (std::size_t axis = 0; axis < 4; ++axis)
    EXPECT_EQ(pair.drive(axis).state(), DriveState::OperationEnabled);
  EXPECT_EQ(pair.drive(0).torque(), 338);  // 1 V: 40 N at a screw of 10 mm, of 0.188136 Nm
  EXPECT_EQ(pair.drive(3).torque(), -677);
}

TEST(CanRealTimePath, AllocatesNothingWhenTheBusIsGone) {
  PairedBus pair;
  ASSERT_TRUE(pair.bus().selfTest().passed);
  pair.closeFarEnd();
  AxisFeedback feedback;
  std::array<double, kAxes> written{};
  allocations = 0;
  armed = true;
  // What the drives had sent before is read first.
  for (int cycle = 0; cycle < 3; ++cycle)
    pair.bus().read(feedback);
  const IoStatus read = pair.bus().read(feedback);
  const IoStatus volts = pair.bus().writeVolts({}, written);
  const IoStatus outputs = pair.bus().writeOutputs(0);
  armed = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_EQ(read, IoStatus::Disconnected);
  EXPECT_EQ(volts, IoStatus::Disconnected);
  EXPECT_EQ(outputs, IoStatus::Disconnected);
  EXPECT_EQ(pair.bus().failure().fault, BusFault::InterfaceDown);
}

}  // namespace
}  // namespace knee_robot::hardware::can
