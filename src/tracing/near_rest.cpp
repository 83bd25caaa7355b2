#include "near_rest.h"

#include "knee_robot/identification/reduction.h"
#include "refit.h"

namespace knee_robot::tracing {
namespace {

/// Laws beside the one that was chosen: stops from fine to long, smooth laws from steep to flat. The data chose among
/// laws of few shapes; a machine's own is none of them, and what is left of it looks like a delay, like Stribeck
/// friction, like presliding.
std::vector<dynamics::FrictionLaw> otherLaws() {
  return {dynamics::stopLaw(2e-5),     dynamics::stopLaw(6e-5),    dynamics::stopLaw(2e-4),
          dynamics::smoothLaw(0.0005), dynamics::smoothLaw(0.002), dynamics::bristleLaw(1e-4)};
}

}  // namespace

void updateNearRest(Search& s) {
  const TraceData& data = *s.data;
  const Eigen::Index p = data.stack.size();
  const std::vector<dynamics::FrictionLaw> laws = otherLaws();
  s.near_rest = Eigen::MatrixXd::Zero(p * data.stack.axes, data.stack.axes * static_cast<Eigen::Index>(laws.size()));
  Eigen::Index at = 0;
  for (int i = 0; i < data.stack.axes; ++i) {
    for (dynamics::FrictionLaw law : laws) {
      law.at_start = s.base->friction_laws[static_cast<std::size_t>(i)].at_start;
      std::vector<Eigen::MatrixXd> columns;
      for (std::size_t r = 0; r < data.recordings.size(); ++r)
        columns.push_back(identification::frictionShare(data.recordings[r].sliding[static_cast<std::size_t>(i)], law) -
                          data.inputs[r].share.col(i));
      s.near_rest.col(at++).segment(i * p, p) = gather(data.stack, data.recordings, std::move(columns));
    }
  }
}

Eigen::MatrixXd projectedColumns(const Search& s, const std::vector<Hypothesis>& effects) {
  const Eigen::MatrixXd model = modelColumns(*s.data, s.rms_N, effects);
  Eigen::MatrixXd all(model.rows(), model.cols() + s.near_rest.cols());
  all << model, weighted(s.data->stack, s.data->scale.asDiagonal() * s.near_rest, s.rms_N);
  return all;
}

Projection projectModel(const Search& s, const std::vector<Hypothesis>& effects) {
  return project(projectedColumns(s, effects), weighted(s.data->stack, s.data->force_rows, s.rms_N), s.base->pull);
}

double shareBeyondLaws(const Search& s, const Hypothesis& h) {
  const TraceData& data = *s.data;
  const Eigen::Index rows = data.force_rows.size(), laws = s.near_rest.cols() / data.stack.axes;
  const Eigen::MatrixXd model = modelColumns(data, s.rms_N, hypothesesOf(s.effects));
  const Eigen::MatrixXd effect = weighted(data.stack, effectRows(data, h), s.rms_N);
  const Eigen::MatrixXd others = data.scale.asDiagonal() * s.near_rest.middleCols(h.place.actuator * laws, laws);
  // The prior's pull as rows of its own: what is left is orthogonal to the model then.
  const Eigen::Index all = rows + s.base->pull.size();
  Eigen::MatrixXd pulled = Eigen::MatrixXd::Zero(all, model.cols());
  pulled.topRows(rows) = model;
  pulled.bottomLeftCorner(all - rows, all - rows).diagonal() = s.base->pull;
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(all, laws + effect.cols());
  both.topRows(rows) << weighted(data.stack, others, s.rms_N), effect;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(all);
  force.head(rows) = weighted(data.stack, data.force_rows, s.rms_N);
  const Projection onto = project(pulled, force);
  both -= onto.q * (onto.q.transpose() * both).eval();
  const bool one_sign = h.place.candidate->coefficients(data.inputs.front()).front().non_negative;
  const auto left = [&](Eigen::Index columns, Eigen::Index bounded) {
    const Eigen::MatrixXd x = both.leftCols(columns);
    const Eigen::VectorXd z = identification::boundedLeastSquares(x, onto.residual, static_cast<int>(bounded));
    return (onto.residual - x * z).squaredNorm();
  };
  const double gained = left(laws, laws) - left(both.cols(), one_sign ? both.cols() : laws);
  return gained / static_cast<double>(data.stack.size());
}

}  // namespace knee_robot::tracing
