#include "other_forces.h"

#include <cmath>
#include <utility>

#include "knee_robot/identification/identify.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::identification {
namespace {

constexpr double kNarrowStop_counts = 2.0;  ///< as IdentifyOptions
constexpr double kUsualError = 0.05;        ///< what a good fit leaves, as weight of the equations against the prior

}  // namespace

std::string whoIs(const mechanism::Robot& robot, int actuator) {
  const std::string& name = robot.actuators[static_cast<std::size_t>(actuator)].name;
  if (name.empty()) return "actuator " + std::to_string(actuator + 1);
  return name.rfind("joint", 0) == 0 ? name : "joint " + name;
}

std::vector<dynamics::FrictionLaw> narrowStops(const mechanism::Robot& robot) {
  std::vector<dynamics::FrictionLaw> laws;
  for (const double width : narrowestWidths(robot, kNarrowStop_counts))
    laws.push_back(dynamics::stopLaw(width));
  return laws;
}

OtherForces::OtherForces(const mechanism::Robot& robot, const std::vector<Column>& columns,
                         std::vector<Observation> training, const ObservationOptions& options,
                         const std::vector<dynamics::FrictionLaw>& laws)
    : columns_(columns), training_(std::move(training)), options_(options) {
  for (Observation& o : training_)
    setFriction(o, columns, laws);
  equations_ = stackEquations(training_, options);
  prior_ = priorOf(robot, columns, rmsPerActuator(equations_, equations_.b).array().max(1e-9));
  const Eigen::MatrixXd forces = recorded();
  spread_ = (forces.rowwise() - forces.colwise().mean()).colwise().norm().transpose() / std::sqrt(rows());
  spread_ = spread_.array().max(1e-9);
}

Eigen::MatrixXd OtherForces::at(int actuator, std::vector<Eigen::MatrixXd> signals) const {
  return atRows(training_, options_, equations_, actuator, std::move(signals));
}

Eigen::MatrixXd OtherForces::beside(int actuator, const Eigen::MatrixXd& forces) const {
  const Eigen::Index last = forces.cols() - 1;
  Eigen::MatrixXd both(rows(), equations_.a.cols() + last);
  both << equations_.a.middleRows(actuator * rows(), rows()), forces.leftCols(last);
  return compress(both, forces.col(last));
}

Eigen::VectorXd OtherForces::errorOf(const std::vector<Eigen::MatrixXd>& blocks,
                                     const std::vector<Force>& forces) const {
  const Eigen::Index n = equations_.a.cols();
  std::vector<Eigen::MatrixXd> weighted;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    Eigen::MatrixXd block(blocks[i].rows(), n + 1);
    block << blocks[i].leftCols(n), forces[i].sign * blocks[i].col(n + forces[i].column);
    weighted.push_back(block / (kUsualError * spread_[forces[i].source]));
  }
  const Reduction reduction = reduce(joinBlocks(weighted, -1), columns_, std::vector<char>(columns_.size(), 1), prior_);
  const Eigen::VectorXd parameters = toParameters(reduction, solveWithPrior(reduction, reduction.maximalRank(), 1.0));
  Eigen::VectorXd error(axes());
  for (int i = 0; i < axes(); ++i) {
    const Eigen::MatrixXd& block = weighted[static_cast<std::size_t>(i)];
    error[i] = kUsualError * (block.leftCols(n) * parameters - block.col(n)).norm() / std::sqrt(rows());
  }
  return error;
}

}  // namespace knee_robot::identification
