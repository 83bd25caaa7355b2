#include "knee_robot/dynamics/chain_regressor.h"
#include "knee_robot/identification/motion_model.h"
#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {
namespace {

/// An open chain from a URDF.
class ChainModel : public MotionModel {
 public:
  explicit ChainModel(const mechanism::Robot& robot) : robot_(robot) {}

  std::vector<Column> columns(bool joint_friction) const override;
  MotionPath follow(const recording::Signals& signals) const override;
  void fillRegressor(const std::vector<Column>& columns, Observation& observation) const override;
  PhysicalCoordinates bodies() const override { return physicalCoordinates(dynamics::chainInertia(robot_)); }
  PredictedForce predict(const dynamics::Model& model, const recording::Signals& signals,
                         const MotionPath& motion) const override;

 private:
  const mechanism::Actuator& joint(int i) const { return robot_.actuators[static_cast<std::size_t>(i)]; }
  int rigid() const { return robot_.axes() * dynamics::kLinkParameters; }
  void fillRigid(const recording::Signals& signals, std::vector<Eigen::MatrixXd>& regressor) const;
  void fillOwn(const std::vector<Column>& columns, const recording::Signals& signals,
               std::vector<Eigen::MatrixXd>& regressor) const;

  const mechanism::Robot& robot_;
};

std::vector<Column> ChainModel::columns(bool) const {
  std::vector<Column> columns;
  const std::vector<std::string> names = dynamics::chainInertialNames(robot_.axes());
  for (int i = 0; i < rigid(); ++i)
    columns.push_back({names[static_cast<std::size_t>(i)], rigidUnit(i), ColumnRole::Rigid, -1});
  const std::pair<ColumnRole, const char*> own[] = {{ColumnRole::Viscous, "Fv_"},
                                                    {ColumnRole::Coulomb, "Fc_"},
                                                    {ColumnRole::Rotor, "rotor_"},
                                                    {ColumnRole::Offset, "offset_"}};
  for (const auto& [role, name] : own) {
    for (int i = 0; i < robot_.axes(); ++i) {
      const double radius = joint(i).jointRadius();
      const bool by_motion = role == ColumnRole::Viscous || role == ColumnRole::Rotor;
      columns.push_back({name + std::to_string(i + 1), unitOf(role, joint(i).revolute), role, i,
                         by_motion ? 1.0 / (radius * radius) : 1.0 / radius});
    }
  }
  return columns;
}

MotionPath ChainModel::follow(const recording::Signals& signals) const {
  MotionPath path;
  const std::size_t n = static_cast<std::size_t>(signals.samples());
  path.pose_known.assign(n, 1);
  path.condition.assign(n, 1.0);
  path.coupled = true;
  return path;
}

void ChainModel::fillRigid(const recording::Signals& s, std::vector<Eigen::MatrixXd>& regressor) const {
  dynamics::ChainRegressorData data(*robot_.chain);
  Eigen::VectorXd per_m(robot_.axes());
  for (int i = 0; i < robot_.axes(); ++i)
    per_m[i] = joint(i).position_per_m();
  for (int n = 0; n < s.samples(); ++n) {
    const Eigen::VectorXd q = s.position_m.row(n).transpose().cwiseProduct(per_m);
    const Eigen::VectorXd v = s.velocity_m_per_s.row(n).transpose().cwiseProduct(per_m);
    const Eigen::VectorXd a = s.acceleration_m_per_s2.row(n).transpose().cwiseProduct(per_m);
    dynamics::chainRegressor(*robot_.chain, robot_.gravity, q, v, a, data);
    for (int i = 0; i < robot_.axes(); ++i)
      regressor[static_cast<std::size_t>(i)].row(n).head(rigid()) = data.regressor.row(i) * per_m[i];
  }
}

void ChainModel::fillOwn(const std::vector<Column>& columns, const recording::Signals& s,
                         std::vector<Eigen::MatrixXd>& regressor) const {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const int i = columns[c].actuator;
    if (i < 0) continue;
    auto column = regressor[static_cast<std::size_t>(i)].col(static_cast<Eigen::Index>(c));
    if (columns[c].role == ColumnRole::Viscous) column = columns[c].newtons * s.velocity_m_per_s.col(i);
    if (columns[c].role == ColumnRole::Rotor) column = columns[c].newtons * s.acceleration_m_per_s2.col(i);
    if (columns[c].role == ColumnRole::Offset) column.setConstant(columns[c].newtons);
  }
}

void ChainModel::fillRegressor(const std::vector<Column>& columns, Observation& o) const {
  fillRigid(o.signals, o.regressor);
  fillOwn(columns, o.signals, o.regressor);
}

PredictedForce ChainModel::predict(const dynamics::Model& model, const recording::Signals& s, const MotionPath&) const {
  const std::vector<Column> all = columns(false);
  std::vector<Eigen::MatrixXd> regressor(static_cast<std::size_t>(robot_.axes()),
                                         Eigen::MatrixXd::Zero(s.samples(), static_cast<Eigen::Index>(all.size())));
  fillRigid(s, regressor);
  fillOwn(all, s, regressor);
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all.size()));
  for (std::size_t c = 0; c < all.size(); ++c) {
    for (const dynamics::ModelParameter& p : model.parameters) {
      if (p.name == all[c].name) parameters[static_cast<Eigen::Index>(c)] = p.value;
    }
  }
  const std::vector<SlidingPath> sliding = actuatorPaths(robot_, s);
  PredictedForce force{Eigen::MatrixXd(s.samples(), robot_.axes()), Eigen::MatrixXd(s.samples(), robot_.axes())};
  for (int i = 0; i < robot_.axes(); ++i) {
    const std::size_t axis = static_cast<std::size_t>(i);
    force.at_sample_N.col(i) = regressor[axis] * parameters;
    force.mean_N.col(i) = force.at_sample_N.col(i);
    for (std::size_t c = 0; c < all.size(); ++c) {
      if (all[c].role != ColumnRole::Coulomb || all[c].actuator != i) continue;
      const double coulomb = parameters[static_cast<Eigen::Index>(c)] * all[c].newtons;
      force.mean_N.col(i) += coulomb * frictionShare(sliding[axis], model.friction[axis]);
      force.at_sample_N.col(i) += coulomb * shareAtSamples(sliding[axis], model.friction[axis]);
    }
  }
  return force;
}

}  // namespace

std::unique_ptr<MotionModel> makeChainModel(const mechanism::Robot& robot) {
  return std::make_unique<ChainModel>(robot);
}

}  // namespace knee_robot::identification
