// inject_fault --shm NAME FAULT [--axis N] [--size X]: orders a fault from the simulated robot while it runs;
// inject_fault clear takes all back. The faults are applied on the robot's side of the registers; the controller is not
// told.

#include <cmath>
#include <functional>
#include <map>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/words.h"
#include "knee_robot/simulation/faulty_port.h"
#include "knee_robot/simulation/shared_image.h"
#include "program.h"

namespace {

using namespace knee_robot;
using simulation::EncoderFault;
using simulation::InjectedFaults;
using simulation::RobotImage;

struct Order {
  int axis = 0;       ///< 1 to 4; 0: all
  double size = 0.0;  ///< meaning and unit depend on the fault
};

using Action = std::function<void(RobotImage&, const Order&)>;

template <typename Do>
void forAxes(const Order& order, Do&& action) {
  for (std::size_t i = 0; i < InjectedFaults::kChannelsOfFaults; ++i) {
    if (order.axis == 0 || static_cast<std::size_t>(order.axis) == i + 1) action(i);
  }
}

Action encoder(EncoderFault fault) {
  return [fault](RobotImage& image, const Order& order) {
    forAxes(order, [&](std::size_t i) {
      image.faults.encoder_size_m[i].store(order.size);
      image.faults.encoder[i].store(static_cast<std::uint8_t>(fault));
    });
  };
}

Action mask(std::atomic<std::uint8_t> simulation::InjectedFaults::*which) {
  return [which](RobotImage& image, const Order& order) {
    unsigned bits = 0;
    forAxes(order, [&](std::size_t i) { bits |= 1u << i; });
    (image.faults.*which).fetch_or(static_cast<std::uint8_t>(bits));
  };
}

Action wire(simulation::WireFault fault) {
  return [fault](RobotImage& image, const Order&) { image.faults.can_wire.store(static_cast<std::uint8_t>(fault)); };
}

void press(std::atomic<std::uint8_t>& button) {
  button.store(1);
}

void takeAllBack(RobotImage& image, const Order&) {
  image.analog.disconnected.store(0);
  image.counter.disconnected.store(0);
  image.counter.answer_delay_us.store(0);
  image.surroundings.emergency_stop_pressed.store(0);
  image.surroundings.hand_switch_pressed.store(0);
  image.surroundings.enabling_switch_held.store(0);
  for (auto& force : image.surroundings.pose_force)
    force.store(0.0);
  simulation::clear(image.faults);
}

const std::map<std::string, Action>& actions() {
  static const std::map<std::string, Action> all = {
      {"encoder_frozen", encoder(EncoderFault::Frozen)},
      {"encoder_jump", encoder(EncoderFault::Jump)},
      {"encoder_wrong_sign", encoder(EncoderFault::WrongSign)},
      {"encoder_noise", encoder(EncoderFault::Noise)},
      {"encoder_disconnected", encoder(EncoderFault::Disconnected)},
      {"encoder_interrupted", encoder(EncoderFault::Interrupted)},
      {"converter_stuck", mask(&InjectedFaults::converter_stuck)},
      {"drive_dead", mask(&InjectedFaults::drive_dead)},
      {"drive_reversed", mask(&InjectedFaults::drive_reversed)},
      {"drive_weak", mask(&InjectedFaults::drive_weak)},
      {"drive_late", mask(&InjectedFaults::drive_late)},
      {"hold_open", mask(&InjectedFaults::hold_open)},
      {"hold_late", mask(&InjectedFaults::hold_late)},
      {"hold_creeps", mask(&InjectedFaults::hold_creeps)},
      {"hold_closed", mask(&InjectedFaults::hold_closed)},
      {"analog_card_lost",
       [](RobotImage& image, const Order&) { image.analog.disconnected.store(simulation::kCardGone); }},
      {"analog_card_silent",
       [](RobotImage& image, const Order&) { image.analog.disconnected.store(simulation::kCardSilent); }},
      {"counter_card_lost",
       [](RobotImage& image, const Order&) { image.counter.disconnected.store(simulation::kCardGone); }},
      {"counter_card_silent",
       [](RobotImage& image, const Order&) { image.counter.disconnected.store(simulation::kCardSilent); }},
      {"slow_card",
       [](RobotImage& image, const Order& order) {
         image.counter.answer_delay_us.store(static_cast<std::uint32_t>(order.size));
       }},
      {"emergency_stop", [](RobotImage& image, const Order&) { press(image.surroundings.emergency_stop_pressed); }},
      {"hand_switch", [](RobotImage& image, const Order&) { press(image.surroundings.hand_switch_pressed); }},
      {"enabling_switch", [](RobotImage& image, const Order&) { press(image.surroundings.enabling_switch_held); }},
      {"push_down", [](RobotImage& image, const Order& order) { image.surroundings.pose_force[1].store(-order.size); }},
      {"component",
       [](RobotImage& image, const Order& order) {
         image.faults.component_fault.store(static_cast<std::uint32_t>(order.size));
       }},
      {"can_silent", mask(&InjectedFaults::can_silent)},
      {"can_no_heartbeat", mask(&InjectedFaults::can_no_heartbeat)},
      {"can_drive_fault", mask(&InjectedFaults::can_fault)},
      {"can_emergency", mask(&InjectedFaults::can_emergency)},
      {"can_cut", wire(simulation::WireFault::Cut)},
      {"can_delayed", wire(simulation::WireFault::Delayed)},
      {"can_reordered", wire(simulation::WireFault::Reordered)},
      {"can_flooded", wire(simulation::WireFault::Flooded)},
      {"can_bus_off", wire(simulation::WireFault::BusOff)},
      {"can_hung_up", [](RobotImage& image, const Order&) { image.faults.can_hung_up.store(1); }},
      {"clear", takeAllBack},
  };
  return all;
}

std::string names() {
  return joined(actions(), [](const auto& one) { return one.first; });
}

}  // namespace

int main(int argc, char** argv) {
  nodes::CommandLine app("Makes a fault in the simulated robot while it runs.", "inject_fault");
  std::string shm = "/knee_robot_sim", name;
  Order order;
  app.option("--shm", shm, "shared memory of the simulated robot").showDefault();
  app.option("--axis", order.axis, "axis 1 to 4; 0: all four").within(0, 4).showDefault();
  app.option("--size", order.size,
             "size of the fault: m (encoder_jump, encoder_noise), N (push_down), us per access "
             "(slow_card), component number (component)")
      .showDefault();
  app.option("fault", name, names()).required();
  return nodes::runProgram(app, argc, argv, [&] {
    const auto found = actions().find(name);
    if (found == actions().end())
      throw InputError("there is no fault '" + name.substr(0, 40) + "'; there are " + names());
    const bool counts_size = name == "slow_card" || name == "component";
    if (!std::isfinite(order.size) || (counts_size && !(order.size >= 0.0 && order.size <= 1e6))) {
      throw InputError("--size " + std::to_string(order.size) + " is no size for " + name);
    }
    simulation::SharedImage memory = simulation::SharedImage::attach(shm);
    found->second(memory.image(), order);
    if (name != "clear") memory.image().faults.generation.fetch_add(1);
    return kExitDone;
  });
}
