#include "knee_robot/identification/evaluation.h"

#include "knee_robot/identification/prediction.h"
#include "knee_robot/recording/filter.h"

namespace knee_robot::identification {

Applied applyModel(const dynamics::Model& model, const mechanism::Robot& robot,
                   const std::vector<Observation>& observations, double cutoff_hz) {
  Applied applied;
  for (const Observation& o : observations) {
    applied.predictions.push_back(makePrediction(o, predictForces(model, robot, o.signals, o.motion), cutoff_hz));
  }
  applied.accuracy = accuracyOf(observations, applied.predictions);
  return applied;
}

std::vector<Eigen::VectorXd> errorAgainstRank(const Identification& id, const std::vector<Observation>& observations,
                                              double cutoff_hz) {
  const Eigen::Index points = static_cast<Eigen::Index>(id.parameters_by_strength.size());
  const Eigen::Index axes = observations.front().axes();
  Eigen::MatrixXd parameters(static_cast<Eigen::Index>(id.columns.size()), points);
  for (Eigen::Index k = 0; k < points; ++k)
    parameters.col(k) = id.parameters_by_strength[static_cast<std::size_t>(k)];
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(axes, points);
  double samples = 0.0;
  for (const Observation& o : observations) {
    for (Eigen::Index i = 0; i < axes; ++i) {
      Eigen::MatrixXd force = o.regressor[static_cast<std::size_t>(i)] * parameters;
      recording::ZeroPhaseLowPass(cutoff_hz, 1.0 / o.signals.period_s).applyToColumns(force);
      force.colwise() -= o.force_filtered_N.col(i);
      for (int n = 0; n < o.samples(); ++n) {
        if (o.moving[static_cast<std::size_t>(n)] && o.isJudged(n)) sum.row(i) += force.row(n).cwiseAbs2();
      }
    }
    for (int n = 0; n < o.samples(); ++n)
      samples += o.moving[static_cast<std::size_t>(n)] && o.isJudged(n);
  }
  std::vector<Eigen::VectorXd> rms;
  for (Eigen::Index k = 0; k < points; ++k)
    rms.push_back((sum.col(k) / samples).cwiseSqrt());
  return rms;
}

}  // namespace knee_robot::identification
