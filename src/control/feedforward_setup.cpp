#include "feedforward_setup.h"

#include <cmath>

#include "delay_margin.h"
#include "home_lengths.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/mechanism/kinematics.h"
#include "model_limits.h"
#include "unchanged_file.h"

namespace knee_robot::control {
namespace {

/// Beside the URDF's weight: twice it is a wrong model, the rest what offsets of drives and an orthosis may be. Nothing
/// takes weight away: a model with less than kLeastShare of it was identified with wrong newtons per volt.
constexpr double kStrangeShare = 1.0, kStrange_N = 60.0, kLeastShare = 0.4;

/// Of a drive's force, to move gently with somebody on the platform.
constexpr double kMostWithPatient = 0.5;

bool isStrange(double said_N, double known_N) {
  const double beside = std::abs(said_N - known_N);
  const bool light = said_N * (known_N < 0.0 ? -1.0 : 1.0) < kLeastShare * std::abs(known_N);
  return beside > kStrangeShare * std::abs(known_N) + kStrange_N || (light && beside > kStrange_N);
}

/// On each axis at home, at rest; nothing where home has no pose.
std::optional<mechanism::Vector4> weightsAtHome(const dynamics::PartedModel& model, const mechanism::Robot& robot) {
  const mechanism::Lengths home = homeLengths(robot);
  const mechanism::ForwardResult found = mechanism::forwardKinematicsFromHome(*robot.mechanism, home);
  if (!found.ok()) return std::nullopt;
  dynamics::ForcePartsData data;
  dynamics::ForceParts parts;
  dynamics::WantedInstant rests;
  rests.position_m = home;
  const bool known = dynamics::forceParts(model, found.pose, rests, data, parts) && parts.allFinite();
  return known ? std::optional<mechanism::Vector4>(parts.gravity) : std::nullopt;
}

/// What the axis moves at home while the others hold; nothing where home has no pose.
std::optional<double> massOf(const dynamics::PartedModel& model, const mechanism::Robot& robot, Eigen::Index axis) {
  const mechanism::Lengths home = homeLengths(robot);
  const mechanism::ForwardResult found = mechanism::forwardKinematicsFromHome(*robot.mechanism, home);
  dynamics::AuxiliaryMotion motion;
  motion.acceleration[axis] = 1.0;
  dynamics::AuxiliaryData data;
  mechanism::Vector4 force = mechanism::Vector4::Zero();
  if (!found.ok() || !dynamics::auxiliaryForces(model, found.pose, motion, data, force)) return std::nullopt;
  return std::max(1.0, force[axis]);
}

}  // namespace

FeedforwardSetup::FeedforwardSetup(const rt::Deployment& deployment, const MachineComponents& machine,
                                   const mechanism::Robot& robot, const std::string& model,
                                   std::optional<double> payload_kg)
    : deployment_(deployment), machine_(machine) {
  ModelFeedforward* const feedforward = machine_.feedforward;
  if (feedforward == nullptr) {
    if (model.empty() && !payload_kg) return;
    throw InputError(
        deployment_.path() +
        ": components: there is no ModelFeedforward that could use a model or a payload; add one, or give neither "
        "model nor payload_kg");
  }
  if (!model.empty()) feedforward->model.set(model);
  if (payload_kg) setPayload(*payload_kg);
  checkLaw();
  const UnchangedFile file(feedforward->model.value());
  feedforward->loadModel();
  readDelays(robot);
  checkDelays();
  compareWeights(robot);
  checkForces(robot);
  const std::string& path = feedforward->model.value();
  if (HandGuide* const guide = machine_.guide) {
    if (guide->model.value().empty()) guide->model.set(path);
    guide->loadModel();
  }
  if (DisturbanceObserver* const observer = machine_.observer) {
    if (observer->model.value().empty()) observer->model.set(path);
    observer->loadModel();
  }
  file.require();
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

void FeedforwardSetup::readDelays(const mechanism::Robot& robot) {
  const std::string& path = machine_.feedforward->model.value();
  if (path.empty() || !robot.mechanism) return;
  const dynamics::Model read = dynamics::loadModel(path);
  const dynamics::PartedModel model(read, robot);
  for (const dynamics::ModelEffect& effect : dynamics::effectsOfController(read)) {
    if (effect.name != "delay" || effect.actuators.size() != 1 || effect.coefficients.empty()) continue;
    const Eigen::Index axis = effect.actuators.front() - 1;
    const std::optional<double> mass = massOf(model, robot, axis);
    const double viscous = std::max(0.0, model.parameters[dynamics::extended::kViscous + axis]);
    if (mass) late_.push_back({effect.actuators.front(), effect.coefficients.front().value, *mass, viscous});
  }
}

void FeedforwardSetup::checkForces(const mechanism::Robot& robot) {
  const std::string& path = machine_.feedforward->model.value();
  if (path.empty()) return;
  const dynamics::PartedModel model(dynamics::loadModel(path), robot);
  const std::string impossible = whatIsTooMuch(model, robot, 1.0);
  if (!impossible.empty())
    throw InputError(path + ": " + impossible + ": the platform would be thrown; identify the model anew");
  const std::string much = whatIsTooMuch(model, robot, kMostWithPatient);
  if (!much.empty() && strange_weights_.empty())
    strange_weights_ = path + " " + much + ", more than half of it: check the model before somebody lies down";
}

/// The brakes open with the model's weight on the drives: what it is wrong by throws the platform up or lets it fall.
void FeedforwardSetup::compareWeights(const mechanism::Robot& robot) {
  const std::string& path = machine_.feedforward->model.value();
  if (path.empty() || !robot.mechanism || robot.urdf.empty()) return;
  const dynamics::PartedModel model(dynamics::loadModel(path), robot);
  const auto said = weightsAtHome(model, robot);
  const auto known = weightsAtHome(dynamics::PartedModel(robot, dynamics::loadRobotInertia(robot)), robot);
  for (Eigen::Index i = 0; said && known && i < said->size() && strange_weights_.empty(); ++i) {
    if (!isStrange((*said)[i], (*known)[i])) continue;
    strange_weights_ =
        path + " gives axis " + std::to_string(i + 1) + " " + shortNumber((*said)[i], 3) +
        " N to carry at home, the URDF's weights are " + shortNumber((*known)[i], 3) +
        " N: the platform would jump when the brakes open (check force_per_volt_N, then identify the model anew)";
  }
}

void FeedforwardSetup::checkDelays() const {
  for (const Driver* driver : machine_.drivers) {
    const std::string why = whyUnstable(*driver);
    if (!why.empty())
      throw InputError(machine_.feedforward->model.value() + ": " + why +
                       "; mend what delays the drive, or lower proportional_N_per_m and derivative_N_s_per_m in " +
                       deployment_.path());
  }
}

/// A drive that acts late makes its position loop unstable sooner or later; no feedforward mends that.
std::string FeedforwardSetup::whyUnstable(const Driver& driver, const std::string& changed, double value) const {
  const auto gain = [&](const rt::Property<double>& one) { return one.name() == changed ? value : one.value(); };
  const PidGains gains{gain(driver.proportional), gain(driver.integral), gain(driver.derivative),
                       gain(driver.derivative_cutoff)};
  for (const LateAxis& late : late_) {
    if (late.axis != driver.axis.value()) continue;
    const double margin = delayMargin(gains, late.mass_kg, late.viscous_N_s_per_m);
    if (late.delay_s <= margin) continue;
    const std::string begin = shortNumber(1e3 * std::max(0.0, margin), 3) + " ms on";
    return "axis " + std::to_string(late.axis) + " acts " + shortNumber(1e3 * late.delay_s, 3) +
           " ms late, and its loop with " + (changed.empty() ? "the" : "these") + " gains of " + driver.name() +
           " is unstable from " + begin;
  }
  return "";
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
