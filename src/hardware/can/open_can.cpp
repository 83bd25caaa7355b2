#include "knee_robot/hardware/can/can_axis_bus.h"
#include "knee_robot/hardware/can/can_socket.h"

namespace knee_robot::hardware::can {
namespace {

class OwningCanBus : public CanAxisBus {
 public:
  OwningCanBus(std::unique_ptr<CanSocket> process, std::unique_ptr<CanSocket> service, const CanSettings& settings,
               const Units& units)
      : CanAxisBus(*process, *service, settings, units), process_(std::move(process)), service_(std::move(service)) {}

 private:
  std::unique_ptr<CanSocket> process_;
  std::unique_ptr<CanSocket> service_;
};

class CanEmergencyOutputs : public EmergencyOutputs {
 public:
  CanEmergencyOutputs(std::unique_ptr<CanSocket> socket, const CanSettings& settings)
      : socket_(std::move(socket)), settings_(settings) {}

  /// Called every millisecond: more often than kRepeat_ns would take the bus from the drives' own frames.
  IoStatus down() noexcept override {
    const std::int64_t now = socket_->now();
    if (now < next_ns_) return last_;
    next_ns_ = now + kRepeat_ns;
    return last_ = quickStop();
  }

 private:
  static constexpr std::int64_t kRepeat_ns = 5'000'000;

  IoStatus quickStop() noexcept {
    Frame dropped;
    for (int i = 0; i < 16 && socket_->receive(dropped) == PortStatus::Ok; ++i) {
    }
    PortStatus worst = PortStatus::Ok;
    const auto send = [&](const Frame& frame) {
      const PortStatus status = socket_->send(frame);
      if (worst == PortStatus::Ok) worst = status;
    };
    for (const DriveSettings& drive : settings_.drives) {
      Frame frame;
      frame.id = kReceivePdoBase + 0x100 + static_cast<std::uint32_t>(drive.node);
      frame.length = 4;  // digital outputs 0
      send(frame);
      frame.id = kReceivePdoBase + static_cast<std::uint32_t>(drive.node);
      putUnsigned(frame, 0, 2, kQuickStop);
      send(frame);
    }
    send(syncFrame());
    return worst == PortStatus::Ok ? IoStatus::Ok : IoStatus::Disconnected;
  }

  std::unique_ptr<CanSocket> socket_;
  const CanSettings settings_;
  std::int64_t next_ns_ = 0;
  IoStatus last_ = IoStatus::Ok;
};

}  // namespace

std::vector<Filter> processFilters(const CanSettings& settings) {
  std::vector<Filter> filters;
  for (const DriveSettings& drive : settings.drives) {
    const auto node = static_cast<std::uint32_t>(drive.node);
    for (const std::uint32_t base : {kEmergencyBase, kTransmitPdoBase, kTransmitPdoBase + 0x100, kHeartbeatBase})
      filters.push_back({base + node, 0x7FF});
  }
  return filters;
}

std::vector<Filter> serviceFilters(const CanSettings& settings) {
  std::vector<Filter> filters;
  for (const DriveSettings& drive : settings.drives) {
    for (const std::uint32_t base : {kSdoAnswerBase, kHeartbeatBase})
      filters.push_back({base + static_cast<std::uint32_t>(drive.node), 0x7FF});
  }
  return filters;
}

std::unique_ptr<AxisBus> openCanDrives(const CanSettings& settings, const CanAxisBus::Units& units) {
  auto process = CanSocket::open(settings.interface, processFilters(settings));
  auto service = CanSocket::open(settings.interface, serviceFilters(settings));
  return std::make_unique<OwningCanBus>(std::move(process), std::move(service), settings, units);
}

std::unique_ptr<EmergencyOutputs> openCanEmergencyOutputs(const CanSettings& settings) {
  return std::make_unique<CanEmergencyOutputs>(CanSocket::open(settings.interface, {{0x7FF, 0x7FF}}), settings);
}

}  // namespace knee_robot::hardware::can
