#include "feedforward_setup.h"

#include "delay_margin.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::control {
namespace {

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

FeedforwardSetup::FeedforwardSetup(const rt::Deployment& deployment, const MachineComponents& machine,
                                   const mechanism::Robot& robot, const std::string& model,
                                   std::optional<double> payload_kg)
    : deployment_(deployment), machine_(machine) {
  ModelFeedforward* const feedforward = machine_.feedforward;
  if (feedforward == nullptr) {
    if (model.empty() && !payload_kg) return;
    throw InputError(deployment_.path() +
                     ": components: there is no ModelFeedforward that could use a model or a payload");
  }
  if (!model.empty()) feedforward->model.set(model);
  if (payload_kg) setPayload(*payload_kg);
  checkLaw();
  feedforward->loadModel();
  checkDelays(robot);
  const std::string& path = feedforward->model.value();
  if (HandGuide* const guide = machine_.guide) {
    if (guide->model.value().empty()) guide->model.set(path);
    guide->loadModel();
  }
  if (DisturbanceObserver* const observer = machine_.observer) {
    if (observer->model.value().empty()) observer->model.set(path);
    observer->loadModel();
  }
}

void FeedforwardSetup::setPayload(double payload_kg) {
  constexpr double kLargest = ModelFeedforward::kLargestPayload_kg;
  if (!(payload_kg >= 0.0 && payload_kg <= kLargest))
    throw InputError("a payload of " + shortNumber(payload_kg) + " kg is outside 0 .. " + shortNumber(kLargest) +
                     " kg");
  machine_.feedforward->payload.set(payload_kg);
}

void FeedforwardSetup::checkLaw() const {
  const std::string where = deployment_.path() + ": components: ";
  try {
    machine_.feedforward->readLaw();
  } catch (const InputError& error) {
    throw InputError(where + error.what());
  }
  for (const Driver* driver : machine_.drivers) {
    const std::string why = whyNotPassive(*driver);
    if (!why.empty()) throw InputError(where + why);
  }
}

/// A drive that acts late makes its position loop unstable sooner or later; no feedforward mends that.
void FeedforwardSetup::checkDelays(const mechanism::Robot& robot) const {
  const std::string& path = machine_.feedforward->model.value();
  if (path.empty() || !robot.mechanism) return;
  const dynamics::Model read = dynamics::loadModel(path);
  for (const dynamics::ModelEffect& effect : read.effects) {
    if (effect.name != "delay" || effect.actuators.size() != 1 || effect.coefficients.empty()) continue;
    const int axis = effect.actuators.front();
    for (const Driver* driver : machine_.drivers) {
      if (driver->axis.value() != axis) continue;
      const double delay = effect.coefficients.front().value;
      const double margin = delayMarginOf(dynamics::PartedModel(read, robot), robot, *driver);
      if (delay <= margin) continue;
      throw InputError(
          path + ": axis " + std::to_string(axis) + " acts " + shortNumber(1e3 * delay, 3) +
          " ms late, and its loop with the gains of " + driver->name() + " is unstable from " +
          shortNumber(1e3 * margin, 3) +
          " ms on; mend what delays the drive, or lower proportional_N_per_m and derivative_N_s_per_m in " +
          deployment_.path());
    }
  }
}

std::string FeedforwardSetup::whyNotPassive(const Driver& driver, const std::string& changed, double value) const {
  const ModelFeedforward* const feedforward = machine_.feedforward;
  if (feedforward == nullptr || feedforward->chosenLaw() != Law::PassivityBased) return "";
  const auto gain = [&](const rt::Property<double>& one) { return one.name() == changed ? value : one.value(); };
  const std::string why = ControlLaw::whyNotPassive(feedforward->lambda, gain(driver.proportional),
                                                    gain(driver.integral), gain(driver.derivative));
  return why.empty() ? ""
                     : feedforward->name() + ".law: passivity_based with the gains of " + driver.name() + ": " + why;
}

std::string FeedforwardSetup::source() const {
  const ModelFeedforward* const feedforward = machine_.feedforward;
  if (feedforward == nullptr) return "none: the deployment has no ModelFeedforward";
  const double payload = feedforward->payload;
  const std::string source = feedforward->source();
  return payload > 0.0 ? source + ", and a payload of " + shortNumber(payload) + " kg" : source;
}

bool FeedforwardSetup::monitorsForces() const {
  return machine_.observer != nullptr && !machine_.observer->model.value().empty();
}

}  // namespace knee_robot::control
