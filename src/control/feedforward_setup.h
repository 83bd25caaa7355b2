#pragma once

#include <optional>
#include <string>
#include <vector>

#include "knee_robot/mechanism/robot.h"
#include "machine_components.h"

namespace knee_robot::control {

/// Gives the components that calculate with a model theirs, and refuses what the model says would not be stable: gains
/// with which the passivity-based law is not passive, drives that act too late for their loop, forces that no drive
/// gives.
class FeedforwardSetup {
 public:
  /// Reads the models. `model` (a file; empty: the deployment's) and `payload_kg` stand in place of the deployment's.
  /// Throws InputError.
  /// `deployment` and `machine` must outlive this.
  FeedforwardSetup(const rt::Deployment& deployment, const MachineComponents& machine, const mechanism::Robot& robot,
                   const std::string& model, std::optional<double> payload_kg);

  /// The passivity-based law is passive with certain gains only: a sentence, or empty. `changed`: a Driver's property
  /// as it would be.
  std::string whyNotPassive(const Driver& driver, const std::string& changed = "", double value = 0.0) const;
  /// A drive that acts as late as the model says makes its loop unstable with certain gains: a sentence, or empty.
  /// `changed`: as above.
  std::string whyUnstable(const Driver& driver, const std::string& changed = "", double value = 0.0) const;
  /// Where the forces come from, for the operator.
  std::string source() const;
  /// Where the identified model carries another weight than the URDF's at home, by far, or asks for more than half of
  /// what a drive gives in a gentle motion: a sentence, or empty.
  const std::string& strangeWeights() const { return strange_weights_; }
  /// An identified model tells what nobody commanded.
  bool monitorsForces() const;

 private:
  /// An axis that acts late, at home, while the others hold.
  struct LateAxis {
    int axis;  ///< 1 to 4
    double delay_s, mass_kg, viscous_N_s_per_m;
  };
  void setPayload(double payload_kg);
  void checkLaw() const;
  void readDelays(const mechanism::Robot& robot);
  void checkDelays() const;
  void checkForces(const mechanism::Robot& robot);
  void compareWeights(const mechanism::Robot& robot);

  const rt::Deployment& deployment_;
  const MachineComponents& machine_;
  std::vector<LateAxis> late_;
  std::string strange_weights_;
};

}  // namespace knee_robot::control
