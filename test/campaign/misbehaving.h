#pragma once

#include <chrono>
#include <limits>
#include <stdexcept>

#include "knee_robot/control/driver.h"
#include "knee_robot/simulation/shared_image.h"
#include "src/control/axes_input.h"
#include "src/control/axes_output.h"
#include "src/control/recorder.h"
#include "src/control/supervisor.h"
#include "src/control/sync.h"

/// Components of the campaign's controller: the product's own, each with a hook that misbehaves when it is told to.
/// What to do is simulation::InjectedFaults::component_fault = 100 * component + misbehaviour (program inject_fault,
/// fault `component`).
namespace knee_robot::campaign {

enum class Part { Sync = 1, Driver = 2, Supervisor = 3, AxesOutput = 4, AxesInput = 5, Recorder = 6 };

enum class Misbehaviour {
  None = 0,
  Exception = 1,
  Hang = 2,  ///< until the order is taken back
  Fatal = 3,
  Silent = 4,      ///< the hook does nothing: what it should write gets stale
  NotANumber = 5,  ///< it writes NaN
  TooLarge = 6,    ///< it writes a set point 10 mm away, or 1000 V
  Pause = 7,       ///< 30 ms, once
  Slow = 8,        ///< 1.6 ms longer every cycle
  Error = 9,       ///< to RunTimeError
};

/// Image of the simulated robot named by environment variable KNEE_CAMPAIGN_SHM, attached at the first call.
simulation::RobotImage& image();

inline Misbehaviour ordered(Part part) {
  const std::uint32_t order = image().faults.component_fault.load(std::memory_order_relaxed);
  return order / 100 == static_cast<std::uint32_t>(part) ? static_cast<Misbehaviour>(order % 100) : Misbehaviour::None;
}

inline void busy(std::chrono::microseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
  }
}

inline void poison(control::SetPoint& point, double value) {
  for (auto* values : {&point.from_m, &point.to_m}) {
    for (double& one : *values)
      one += value;
  }
}

/// Reads what a component has just written; a component of its own, as the deployment must not see the port.
template <Part part>
struct Tap {};
template <>
struct Tap<Part::Sync> {
  rt::TaskContext owner{"campaign_tap"};
  rt::InputPort<control::SetPoint> port{owner, "tap", ""};
};
template <>
struct Tap<Part::Driver> {
  rt::TaskContext owner{"campaign_tap"};
  rt::InputPort<control::AxisCommand> port{owner, "tap", ""};
};

template <class Component, Part part>
class Misbehaving : public Component {
 public:
  template <typename... Arguments>
  explicit Misbehaving(Arguments&&... arguments) : Component(std::forward<Arguments>(arguments)...) {
    image();  // attached before anything is real-time
    if constexpr (part == Part::Sync) rt::connect(this->set_point, tap_.port);
    if constexpr (part == Part::Driver) rt::connect(this->command, tap_.port);
  }

 protected:
  void updateHook(const rt::Cycle& cycle) override {
    const Misbehaviour now = concerned() ? ordered(part) : Misbehaviour::None;
    const bool first = now != last_;
    last_ = now;
    switch (now) {
      case Misbehaviour::Exception:
        throw std::runtime_error("ordered by the fault campaign");
      case Misbehaviour::Hang:
        while (ordered(part) == Misbehaviour::Hang) {
        }
        break;
      case Misbehaviour::Fatal:
        return this->fatal("ordered by the fault campaign");
      case Misbehaviour::Error:
        return this->error();
      case Misbehaviour::Silent:
        return;
      case Misbehaviour::Pause:
        if (first) busy(std::chrono::milliseconds(30));
        break;
      case Misbehaviour::Slow:
        busy(std::chrono::microseconds(1600));
        break;
      default:
        break;
    }
    Component::updateHook(cycle);
    if (now == Misbehaviour::NotANumber) falsify(std::numeric_limits<double>::quiet_NaN());
    if (now == Misbehaviour::TooLarge) falsify(part == Part::Sync ? 0.01 : 1000.0);
  }

 private:
  /// Of the four Drivers, the first.
  bool concerned() const {
    if constexpr (part == Part::Driver) return this->axis.value() == 1;
    return true;
  }

  /// Writes once more what the component has just written, spoilt.
  void falsify(double by) {
    if constexpr (part == Part::Sync) {
      knee_robot::control::SetPoint spoilt;
      tap_.port.read(spoilt);
      poison(spoilt, by);
      this->set_point.write(spoilt);
    }
    if constexpr (part == Part::Driver) {
      knee_robot::control::AxisCommand spoilt;
      tap_.port.read(spoilt);
      spoilt.volts += by;
      this->command.write(spoilt);
    }
  }

  Tap<part> tap_;
  Misbehaviour last_ = Misbehaviour::None;
};

}  // namespace knee_robot::campaign
