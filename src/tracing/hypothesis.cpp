#include "knee_robot/tracing/hypothesis.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>

namespace knee_robot {
namespace {

constexpr double kAbsorbed = 1e-3;  ///< share of a column's square that must survive the model's columns

void addShapes(const Candidate& candidate, const EffectInput& input, int actuator, std::vector<Hypothesis>& list) {
  for (std::vector<double>& shape : candidate.shapes(input, actuator))
    list.push_back({{&candidate, actuator}, std::move(shape)});
}

}  // namespace

void setAttention(TraceData& data, Attention attention) {
  data.scale = rowScale(data.stack, data.recordings, attention);
  data.base_rows = data.scale.asDiagonal() * data.all_base_rows;
  data.force_rows = data.scale.asDiagonal() * data.all_force_rows;
}

std::vector<Hypothesis> listHypotheses(const CandidateList& candidates, const std::vector<EffectInput>& inputs) {
  std::vector<Hypothesis> list;
  for (const auto& candidate : candidates) {
    if (!candidate->shared()) {
      for (int i = 0; i < inputs.front().axes(); ++i)
        addShapes(*candidate, inputs.front(), i, list);
      continue;
    }
    const std::size_t recordings = candidate->transfers() ? 1 : inputs.size();  // a window lies in one recording
    for (std::size_t r = 0; r < recordings; ++r)
      addShapes(*candidate, inputs[r], -1, list);
  }
  return list;
}

Eigen::MatrixXd effectColumns(const EffectInput& input, const Hypothesis& h, int actuator) {
  if (h.place.actuator >= 0 && h.place.actuator != actuator) {
    return Eigen::MatrixXd::Zero(input.samples(),
                                 static_cast<Eigen::Index>(h.place.candidate->coefficients(input).size()));
  }
  return h.place.candidate->columns(input, actuator, h.shape);
}

Eigen::MatrixXd effectRows(const TraceData& data, const Hypothesis& h) {
  const Eigen::Index p = data.stack.size();
  const Eigen::Index k = static_cast<Eigen::Index>(h.place.candidate->coefficients(data.inputs.front()).size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(p * data.stack.axes, k);
  for (int i = 0; i < data.stack.axes; ++i) {
    if (h.place.actuator >= 0 && h.place.actuator != i) continue;
    std::vector<Eigen::MatrixXd> columns;
    for (const EffectInput& input : data.inputs)
      columns.push_back(h.place.candidate->columns(input, i, h.shape));
    rows.middleRows(i * p, p) = gather(data.stack, data.recordings, std::move(columns));
  }
  return data.scale.asDiagonal() * rows;
}

Eigen::MatrixXd weighted(const Stack& stack, Eigen::MatrixXd rows, const Eigen::VectorXd& noise_N) {
  for (int i = 0; i < stack.axes; ++i)
    rows.middleRows(i * stack.size(), stack.size()) /= noise_N[i];
  return rows;
}

Projection project(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  Projection p;
  p.q = qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
  p.residual = force - p.q * (p.q.transpose() * force);
  return p;
}

Probe makeProbe(const TraceData& data, const Hypothesis& h, const Projection& projection,
                const Eigen::VectorXd& noise_N) {
  Probe probe;
  const Eigen::Index p = data.stack.size();
  const std::vector<Coefficient> coefficients = h.place.candidate->coefficients(data.inputs.front());
  probe.one_sign = coefficients.size() == 1 && coefficients.front().non_negative;
  probe.columns = weighted(data.stack, effectRows(data, h), noise_N);
  Eigen::MatrixXd shadow;
  if (h.place.actuator >= 0) {
    probe.first_row = h.place.actuator * p;
    probe.columns = probe.columns.middleRows(probe.first_row, p).eval();
    shadow = projection.q.middleRows(probe.first_row, p).transpose() * probe.columns;
  } else {
    shadow = projection.q.transpose() * probe.columns;
  }
  const Eigen::MatrixXd whole = probe.columns.transpose() * probe.columns;
  const Eigen::MatrixXd left = whole - shadow.transpose() * shadow;
  const Eigen::VectorXd scale = whole.diagonal().cwiseSqrt().cwiseMax(1e-12);
  const Eigen::VectorXd inverse_scale = scale.cwiseInverse();
  const Eigen::MatrixXd scaled = inverse_scale.asDiagonal() * left * inverse_scale.asDiagonal();
  if (scaled.diagonal().maxCoeff() < kAbsorbed) return probe;
  const Eigen::MatrixXd ridge = scaled + kAbsorbed * Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols());
  probe.inverse = inverse_scale.asDiagonal() *
                  ridge.ldlt().solve(Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols())) *
                  inverse_scale.asDiagonal();
  return probe;
}

double explained(const Probe& probe, const Eigen::VectorXd& residual) {
  if (probe.inverse.size() == 0) return 0.0;
  const Eigen::VectorXd b = probe.columns.transpose() * residual.segment(probe.first_row, probe.columns.rows());
  if (probe.one_sign && b[0] <= 0.0) return 0.0;
  return b.dot(probe.inverse * b);
}

}  // namespace knee_robot
