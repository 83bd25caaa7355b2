#include "force_model_prediction.h"
#include "knee_robot/identification/motion_model.h"
#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {
namespace {

void fillAxes(const std::vector<Column>& columns, Observation& o) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const int i = columns[c].actuator;
    Eigen::MatrixXd& regressor = o.regressor[static_cast<std::size_t>(i)];
    const Eigen::Index at = static_cast<Eigen::Index>(c);
    if (columns[c].role == ColumnRole::Viscous) regressor.col(at) = o.signals.velocity_m_per_s.col(i);
    if (columns[c].role == ColumnRole::Rotor) regressor.col(at) = o.signals.acceleration_m_per_s2.col(i);
    if (columns[c].role == ColumnRole::Offset) regressor.col(at).setOnes();
  }
}

MotionPath pathWithoutPlatform(const recording::Signals& signals) {
  MotionPath path;
  const std::size_t n = static_cast<std::size_t>(signals.samples());
  path.pose_known.assign(n, 1);
  path.condition.assign(n, 1.0);
  return path;
}

/// Independent axes on a bench.
class AxesModel : public MotionModel {
 public:
  explicit AxesModel(const mechanism::Robot& robot) : robot_(robot) {}

  std::vector<Column> columns(bool joint_friction) const override;
  MotionPath follow(const recording::Signals& signals) const override { return pathWithoutPlatform(signals); }
  void fillRegressor(const std::vector<Column>& columns, Observation& o) const override { fillAxes(columns, o); }
  PhysicalCoordinates bodies() const override { return {}; }
  PredictedForce predict(const dynamics::Model& model, const recording::Signals& signals,
                         const MotionPath& motion) const override {
    return predictByForceModel(model, robot_, signals, motion);
  }

 private:
  const mechanism::Robot& robot_;
};

std::vector<Column> AxesModel::columns(bool) const {
  std::vector<Column> columns;
  const std::vector<std::string> names = dynamics::axisParameterNames(robot_.axes());
  const ColumnRole roles[] = {ColumnRole::Viscous, ColumnRole::Coulomb, ColumnRole::Rotor, ColumnRole::Offset};
  for (std::size_t i = 0; i < names.size(); ++i) {
    columns.push_back({names[i], unitOf(roles[i % 4]), roles[i % 4], static_cast<int>(i / 4)});
  }
  return columns;
}

}  // namespace

std::unique_ptr<MotionModel> makeAxesModel(const mechanism::Robot& robot) {
  return std::make_unique<AxesModel>(robot);
}

}  // namespace knee_robot::identification
