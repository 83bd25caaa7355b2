#include "control_parts.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/control/delay_margin.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::control {
namespace {

template <typename Component>
Component* atMostOne(const rt::Deployment& deployment, const char* type) {
  Component* found = nullptr;
  for (const auto& component : deployment.components()) {
    auto* one = dynamic_cast<Component*>(component.get());
    if (one == nullptr) continue;
    if (found != nullptr) throw InputError(deployment.path() + ": components: there must be one " + type + ", not two");
    found = one;
  }
  return found;
}

template <typename Component>
Component* only(const rt::Deployment& deployment, const char* type) {
  Component* found = atMostOne<Component>(deployment, type);
  if (found == nullptr) throw InputError(deployment.path() + ": components: there is no " + type + "; add one");
  return found;
}

void checkDrivers(const rt::Deployment& deployment) {
  std::array<int, hardware::kAxes> drivers{};
  for (const auto& component : deployment.components()) {
    const auto* driver = dynamic_cast<const Driver*>(component.get());
    if (driver != nullptr) ++drivers[static_cast<std::size_t>(driver->axis.value()) - 1];
  }
  for (int i = 0; i < hardware::kAxes; ++i) {
    if (drivers[static_cast<std::size_t>(i)] == 1) continue;
    throw InputError(deployment.path() + ": components: axis " + std::to_string(i + 1) + " has " +
                     std::to_string(drivers[static_cast<std::size_t>(i)]) + " Drivers; it needs one");
  }
}

/// Of the axis at home, while the others hold.
double delayMarginOf(const dynamics::PartedModel& model, const mechanism::Robot& robot, const Driver& driver) {
  mechanism::Lengths home;
  for (Eigen::Index i = 0; i < home.size(); ++i)
    home[i] = robot.actuators[static_cast<std::size_t>(i)].home_length_m;
  const mechanism::ForwardResult found = mechanism::forwardKinematicsFromHome(*robot.mechanism, home);
  const Eigen::Index k = driver.axis.value() - 1;
  dynamics::AuxiliaryMotion motion;
  motion.acceleration[k] = 1.0;
  dynamics::AuxiliaryData data;
  mechanism::Vector4 force = mechanism::Vector4::Zero();
  if (!found.ok() || !dynamics::auxiliaryForces(model, found.pose, motion, data, force)) return 1.0;
  const double viscous = model.parameters[dynamics::extended::kViscous + k];
  return delayMargin({driver.proportional, driver.integral, driver.derivative, driver.derivative_cutoff},
                     std::max(1.0, force[k]), std::max(0.0, viscous));
}

}  // namespace

ControlSystem::Parts::Parts(const rt::Deployment& deployment)
    : sync(only<Sync>(deployment, "Sync")),
      recorder(only<Recorder>(deployment, "Recorder")),
      supervisor(only<Supervisor>(deployment, "Supervisor")),
      input(only<AxesInput>(deployment, "AxesInput")),
      output(only<AxesOutput>(deployment, "AxesOutput")),
      monitors(only<Monitors>(deployment, "Monitors")),
      black_box(only<BlackBox>(deployment, "BlackBox")),
      feedforward(atMostOne<ModelFeedforward>(deployment, "ModelFeedforward")),
      observer(atMostOne<DisturbanceObserver>(deployment, "DisturbanceObserver")),
      guide(atMostOne<HandGuide>(deployment, "HandGuide")) {
  checkDrivers(deployment);
  checkOrder(deployment);
}

void ControlSystem::Parts::prepareFeedforward(const rt::Deployment& deployment, const mechanism::Robot& robot,
                                              const Options& options) {
  if (feedforward == nullptr) {
    if (options.model.empty() && !options.payload_kg) return;
    throw InputError(deployment.path() +
                     ": components: there is no ModelFeedforward that could use a model or a payload");
  }
  if (!options.model.empty()) feedforward->model.set(options.model);
  if (options.payload_kg &&
      !(*options.payload_kg >= 0.0 && *options.payload_kg <= ModelFeedforward::kLargestPayload_kg))
    throw InputError("a payload of " + shortNumber(*options.payload_kg) + " kg is outside 0 .. " +
                     shortNumber(ModelFeedforward::kLargestPayload_kg) + " kg");
  if (options.payload_kg) feedforward->payload.set(*options.payload_kg);
  checkLaw(deployment);
  feedforward->loadModel();
  checkDelays(deployment, robot);
  if (guide != nullptr) {
    if (guide->model.value().empty()) guide->model.set(feedforward->model.value());
    guide->loadModel();
  }
  if (observer == nullptr) return;
  if (observer->model.value().empty()) observer->model.set(feedforward->model.value());
  observer->loadModel();
}

void ControlSystem::Parts::checkLaw(const rt::Deployment& deployment) const {
  const std::string where = deployment.path() + ": components: ";
  try {
    feedforward->readLaw();
  } catch (const InputError& error) {
    throw InputError(where + error.what());
  }
  for (const auto& component : deployment.components()) {
    const auto* driver = dynamic_cast<const Driver*>(component.get());
    const std::string why = driver == nullptr ? "" : whyNotPassive(*driver);
    if (!why.empty()) throw InputError(where + why);
  }
}

/// A drive that acts late makes its position loop unstable sooner or later; no feedforward mends that.
void ControlSystem::Parts::checkDelays(const rt::Deployment& deployment, const mechanism::Robot& robot) const {
  const std::string& path = feedforward->model.value();
  if (path.empty() || !robot.mechanism) return;
  const dynamics::Model read = dynamics::loadModel(path);
  for (const dynamics::ModelEffect& effect : read.effects) {
    if (effect.name != "delay" || effect.actuators.size() != 1 || effect.coefficients.empty()) continue;
    const int axis = effect.actuators.front();
    for (const auto& component : deployment.components()) {
      const auto* driver = dynamic_cast<const Driver*>(component.get());
      if (driver == nullptr || driver->axis.value() != axis) continue;
      const double delay = effect.coefficients.front().value;
      const double margin = delayMarginOf(dynamics::PartedModel(read, robot), robot, *driver);
      if (delay <= margin) continue;
      throw InputError(
          path + ": axis " + std::to_string(axis) + " acts " + shortNumber(1e3 * delay, 3) +
          " ms late, and its loop with the gains of " + driver->name() + " is unstable from " +
          shortNumber(1e3 * margin, 3) +
          " ms on; mend what delays the drive, or lower proportional_N_per_m and derivative_N_s_per_m in " +
          deployment.path());
    }
  }
}

std::string ControlSystem::Parts::whyNotPassive(const Driver& driver, const std::string& changed, double value) const {
  if (feedforward == nullptr || feedforward->chosenLaw() != Law::PassivityBased) return "";
  const auto gain = [&](const rt::Property<double>& one) { return one.name() == changed ? value : one.value(); };
  const std::string why = ControlLaw::whyNotPassive(feedforward->lambda, gain(driver.proportional),
                                                    gain(driver.integral), gain(driver.derivative));
  return why.empty() ? ""
                     : feedforward->name() + ".law: passivity_based with the gains of " + driver.name() + ": " + why;
}

/// One thread uses the bus; what is read in a cycle is answered in the same cycle, and a row of the recording is of one cycle.
void ControlSystem::Parts::checkOrder(const rt::Deployment& deployment) const {
  const std::string where = deployment.path() + ": components: ";
  const rt::Activity* servo = deployment.activityOf(*input);
  const std::vector<rt::TaskContext*>& order = servo->components();
  const auto place = [&](const rt::TaskContext* component) { return std::find(order.begin(), order.end(), component); };
  const rt::TaskContext* together[] = {output, recorder, supervisor, monitors, black_box};
  if (std::any_of(std::begin(together), std::end(together),
                  [&](const auto* one) { return place(one) == order.end(); })) {
    throw InputError(where +
                     "AxesInput, Monitors, Supervisor, AxesOutput, Recorder and BlackBox must belong to one activity");
  }
  if (place(input) != order.begin())
    throw InputError(where + "AxesInput must be the first of activity " + servo->name());
  for (auto after = place(monitors); after != order.end(); ++after) {
    if (dynamic_cast<const Driver*>(*after) != nullptr)
      throw InputError(where + "Monitors must come after the Drivers");
  }
  const auto is_driver = [](const rt::TaskContext* one) { return dynamic_cast<const Driver*>(one) != nullptr; };
  const bool too_late =
      feedforward != nullptr && std::find_if(order.begin(), order.end(), is_driver) < place(feedforward);
  if (too_late) throw InputError(where + "ModelFeedforward must come before the Drivers, in their activity");
  const bool looks_late = observer != nullptr && std::find_if(order.begin(), order.end(), is_driver) < place(observer);
  if (looks_late) throw InputError(where + "DisturbanceObserver must come before the Drivers, in their activity");
  const bool guides_late = guide != nullptr && std::find_if(order.begin(), order.end(), is_driver) < place(guide);
  if (guides_late) throw InputError(where + "HandGuide must come before the Drivers, in their activity");
  if (place(supervisor) < place(monitors)) throw InputError(where + "Supervisor must come after Monitors");
  for (auto after = place(output); after != order.end(); ++after) {
    if (dynamic_cast<const Driver*>(*after) != nullptr || *after == supervisor) {
      throw InputError(where + "AxesOutput must come after the Supervisor and the Drivers of its activity");
    }
  }
  if (place(recorder) < place(output) || place(black_box) < place(output))
    throw InputError(where + "Recorder and BlackBox must come after AxesOutput");
}

}  // namespace knee_robot::control
