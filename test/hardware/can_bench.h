#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "knee_robot/hardware/can/can_axis_bus.h"
#include "knee_robot/hardware/can/object_dictionary.h"
#include "knee_robot/simulation/drive_model.h"

namespace knee_robot::hardware::can {

/// A CAN bus in one process with a clock of its own: the controller's ports, the drives at the far side, and faults
/// between.
/// Frames arrive at once, in order, unless a hook says otherwise.
class BenchBus {
 public:
  class Port : public FramePort {
   public:
    Port(BenchBus& bus, std::vector<Filter> filters, bool of_drives)
        : bus_(bus), filters_(std::move(filters)), of_drives_(of_drives) {}
    PortStatus send(const Frame& frame) noexcept override { return bus_.send(frame, *this); }
    PortStatus receive(Frame& frame) noexcept override {
      if (bus_.down && !of_drives_) return PortStatus::Down;
      if (bus_.before_receive && !of_drives_) bus_.before_receive();
      if (queue.empty()) return PortStatus::Empty;
      frame = queue.front();
      queue.pop_front();
      return PortStatus::Ok;
    }
    std::int64_t now() noexcept override { return bus_.now(); }
    void pause(std::int64_t duration_ns) override { bus_.advance(duration_ns); }

    std::deque<Frame> queue;

   private:
    friend class BenchBus;
    bool wants(const Frame& frame) const {
      if (frame.error || filters_.empty()) return true;
      for (const Filter& filter : filters_)
        if ((frame.id & filter.mask) == (filter.id & filter.mask)) return true;
      return false;
    }
    BenchBus& bus_;
    std::vector<Filter> filters_;
    bool of_drives_;
  };

  Port& addPort(std::vector<Filter> filters) {
    ports_.push_back(std::make_unique<Port>(*this, std::move(filters), false));
    return *ports_.back();
  }
  Port& drivesPort() { return drives_port_; }

  std::int64_t now() const { return now_; }
  void advance(std::int64_t duration_ns) {
    for (std::int64_t left = duration_ns; left > 0; left -= kStep) {
      now_ += std::min(left, kStep);
      if (on_time) on_time(now_);
    }
  }
  /// Puts a frame on the bus as if somebody else had sent it: everybody gets it.
  void inject(const Frame& frame) {
    deliver(frame, nullptr);
    if (to_drives) to_drives(frame);
  }

  std::function<void(const Frame&)> to_drives;         ///< the drives' receiver
  std::function<void(std::int64_t)> on_time;           ///< the drives' clock
  std::function<void()> before_receive;                ///< before the controller looks
  std::function<bool(const Frame&)> passes_to_drives;  ///< false: lost
  std::function<bool(Frame&)> passes_to_controller;    ///< false: lost or held back
  bool down = false;
  bool full = false;
  std::vector<Frame> log;  ///< everything that was sent, while `logging`
  bool logging = false;

 private:
  static constexpr std::int64_t kStep = 500'000;

  PortStatus send(const Frame& frame, const Port& sender) noexcept {
    if (down && !sender.of_drives_) return PortStatus::Down;
    if (full && !sender.of_drives_) return PortStatus::Full;
    if (down) return PortStatus::Ok;
    if (logging) log.push_back(frame);
    deliver(frame, &sender);
    if (!sender.of_drives_ && to_drives && (!passes_to_drives || passes_to_drives(frame))) to_drives(frame);
    return PortStatus::Ok;
  }
  void deliver(Frame frame, const Port* sender) {
    frame.received_ns = now_;
    const bool of_drives = sender == &drives_port_;
    if (of_drives && passes_to_controller && !passes_to_controller(frame)) return;
    for (const auto& port : ports_)
      if (port.get() != sender && port->wants(frame) && port->queue.size() < 1000) port->queue.push_back(frame);
  }

  Port drives_port_{*this, {}, true};
  std::vector<std::unique_ptr<Port>> ports_;
  std::int64_t now_ = 1'000'000'000;
};

inline ObjectDictionary driveTable() {
  return ObjectDictionary::load(std::string(KNEE_SOURCE_DIR) + "/config/hardware/can_objects.yaml");
}

/// Four drives as the simulated ones are described: nodes 1 to 4.
inline CanSettings benchSettings() {
  CanSettings settings;
  settings.interface = "bench";
  settings.vendor = 0xFB;
  settings.product = 0x60500000;
  for (std::size_t i = 0; i < settings.drives.size(); ++i)
    settings.drives[i] = {static_cast<int>(i) + 1, std::nullopt, 0.188136, 3.12, 15.0};
  settings.drive_enable_bit = 0;
  return settings;
}

/// 1 V is 40 N at a 10 mm screw: 338 per mille, so that 10 V stay below the current limit.
inline CanAxisBus::Units benchUnits() {
  CanAxisBus::Units units;
  units.fill({40.0, 0.010, 0.188136});
  return units;
}

/// Four drive models on a bench bus, and the controller's CanAxisBus on it, with what the conformance suite sees and
/// does.
class CanBench {
 public:
  explicit CanBench(CanSettings settings = benchSettings(), CanAxisBus::Units units = benchUnits())
      : settings_(std::move(settings)), units_(units) {
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      drives_[i] = std::make_unique<simulation::DriveModel>(settings_.drives[i].node, driveTable(), wire.drivesPort());
    }
    wire.to_drives = [this](const Frame& frame) {
      for (const auto& drive : drives_)
        drive->take(frame);  // all of them at one instant: a frame is on the whole bus at once
      seen_outputs_.push_back(terminalVolts());
    };
    wire.on_time = [this](std::int64_t now) {
      for (const auto& drive : drives_)
        drive->step(now);
    };
    BenchBus::Port& process = wire.addPort(processFilters(settings_));
    bus_ = std::make_unique<CanAxisBus>(process, wire.addPort(serviceFilters(settings_)), settings_, units_);
    // While moving: one count and one SYNC before each emptying of the queue.
    wire.before_receive = [this, &process] {
      if (!moving_ || !process.queue.empty()) return;
      sampled_ = !sampled_;
      if (sampled_) move(1);
    };
  }

  AxisBus& bus() { return *bus_; }
  CanAxisBus& canBus() { return *bus_; }
  simulation::DriveModel& drive(std::size_t axis) { return *drives_.at(axis); }

  /// Brings the drives to Operation Enabled, with the enabling bit as the only output.
  bool energise() {
    if (bus_->writeOutputs(1) != IoStatus::Ok) return false;
    for (int i = 0; i < 20; ++i)
      cycle({});
    for (const auto& drive : drives_)
      if (drive->state() != DriveState::OperationEnabled) return false;
    return true;
  }
  /// While set, feedback stays away for longer than is tolerated.
  void holdFeedbackBack(bool on) {
    wire.passes_to_controller = nullptr;
    if (on) wire.passes_to_controller = [](Frame& frame) { return frame.id < 0x180 || frame.id > 0x2FF; };
    for (int i = 0; on && i < 6; ++i)
      cycle({});
  }
  /// One servo period as the controller has it.
  IoStatus cycle(const std::array<double, kAxes>& volts) {
    wire.advance(2'000'000);
    const IoStatus status = bus_->read(feedback);
    bus_->writeVolts(volts, written);
    return status;
  }

  double voltStep() const { return voltsOf(1.0, units_[0]); }
  double highestVolts() const { return voltsOf(toPerMille(kLargestVolts, units_[0], 32767), units_[0]); }
  double lowestVolts() const { return -highestVolts(); }
  std::array<double, kAxes> terminalVolts() const {
    std::array<double, kAxes> volts{};
    for (std::size_t i = 0; i < volts.size(); ++i)
      volts[i] = voltsOf(drives_[i]->torque(), units_[i]);
    return volts;
  }
  std::uint8_t terminalOutputs() const { return drives_[0]->outputs(); }
  void setInputs(std::uint8_t bits) {
    for (const auto& drive : drives_)
      drive->setInputs(bits);
    sample();
  }
  void move(std::uint32_t counts) {
    for (const auto& drive : drives_) {
      const auto before = static_cast<std::uint32_t>(drive->dictionary().get(objects::kPosition));
      drive->setPosition(static_cast<std::int32_t>(before + counts));
    }
    sample();
  }
  void keepMoving(bool on) { moving_ = on; }
  std::vector<std::array<double, kAxes>>& seenOutputs() { return seen_outputs_; }
  void disconnect() { wire.down = true; }
  void reconnect() { wire.down = false; }

  BenchBus wire;
  AxisFeedback feedback;
  std::array<double, kAxes> written{};

  /// What the drives have now is sent, as the next SYNC would have it.
  void sample() {
    if (!wire.down) wire.inject(syncFrame());
  }

 private:
  CanSettings settings_;
  CanAxisBus::Units units_;
  std::array<std::unique_ptr<simulation::DriveModel>, kAxes> drives_;
  std::unique_ptr<CanAxisBus> bus_;
  std::vector<std::array<double, kAxes>> seen_outputs_;
  bool moving_ = false;
  bool sampled_ = false;
};

}  // namespace knee_robot::hardware::can
