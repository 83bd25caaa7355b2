#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/prior.h"

namespace knee_robot::identification {

/// "actuator 2", or of a chain "joint NAME" ("joint_2" where the name says so itself).
std::string whoIs(const mechanism::Robot& robot, int actuator);

/// A stop as narrow as the encoder allows, for every actuator.
std::vector<dynamics::FrictionLaw> narrowStops(const mechanism::Robot& robot);

/// The training equations, to be fitted to other forces than the recorded ones: with other signs, of other actuators, of
/// other times. The Coulomb columns are those of given laws near rest, one per actuator: the training's own were chosen for
/// the recording as it is.
class OtherForces {
 public:
  OtherForces(const mechanism::Robot& robot, const std::vector<Column>& columns, std::vector<Observation> training,
              const ObservationOptions& options, const std::vector<dynamics::FrictionLaw>& laws);

  int axes() const { return equations_.axes; }
  Eigen::Index rows() const { return equations_.rows() / equations_.axes; }  ///< per actuator
  /// The recorded ones, rows x actuators.
  Eigen::MatrixXd recorded() const { return equations_.b.reshaped(rows(), axes()); }
  /// Signals of every training file (samples x signals), low-passed, at the rows of an actuator.
  Eigen::MatrixXd at(int actuator, std::vector<Eigen::MatrixXd> signals) const;
  const std::vector<Observation>& training() const { return training_; }

  /// An actuator's columns beside forces (rows x forces), compressed.
  Eigen::MatrixXd beside(int actuator, const Eigen::MatrixXd& forces) const;
  /// Which of beside()'s forces is fitted, with which sign, and the actuator that recorded it.
  struct Force {
    Eigen::Index column;
    double sign;
    int source;
  };
  /// rms error over what varies in the force, per actuator, of the model that fits one force each.
  Eigen::VectorXd errorOf(const std::vector<Eigen::MatrixXd>& blocks, const std::vector<Force>& forces) const;

 private:
  std::vector<Column> columns_;
  std::vector<Observation> training_;
  ObservationOptions options_;
  Equations equations_;
  Prior prior_;
  Eigen::VectorXd spread_;  ///< rms of every recorded force about its mean
};

}  // namespace knee_robot::identification
