#include "knee_robot/tracing/hypothesis.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>

#include "knee_robot/base/parallel.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::tracing {
namespace {

constexpr double kAbsorbed = 1e-3;  ///< share of a column's square that must survive the model's columns
constexpr Eigen::Index kPieceRows = 256, kPieceShape = 4;  ///< least rows of a piece, and rows for each column
constexpr Eigen::Index kColumnsAtOnce = 96;                ///< that are built on the grid before they are thinned

void addShapes(const Candidate& candidate, const EffectInput& input, int actuator, std::vector<Hypothesis>& list) {
  if (!candidate.shownIn(input, actuator)) return;
  for (std::vector<double>& shape : candidate.shapes(input, actuator))
    list.push_back({{&candidate, actuator}, std::move(shape)});
}

/// Of columns made orthogonal to the model's, given the model's share of them. Empty when nothing is left.
Eigen::MatrixXd inverseGram(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& shadow, double& survives) {
  const Eigen::MatrixXd whole = columns.transpose() * columns;
  const Eigen::MatrixXd left = whole - shadow.transpose() * shadow;
  const Eigen::VectorXd inverse_scale = whole.diagonal().cwiseSqrt().cwiseMax(1e-12).cwiseInverse();
  const Eigen::MatrixXd scaled = inverse_scale.asDiagonal() * left * inverse_scale.asDiagonal();
  survives = scaled.diagonal().maxCoeff();
  if (survives < kAbsorbed) return {};
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols());
  return inverse_scale.asDiagonal() * (scaled + kAbsorbed * unit).ldlt().solve(unit) * inverse_scale.asDiagonal();
}

/// Orthonormal, of the columns' span. Rows in pieces that fit into a processor's cache, side by side; their triangles
/// decide on the rank.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) {
  using Householder = Eigen::HouseholderQR<Eigen::MatrixXd>;
  const Eigen::Index p = columns.cols(), rows = columns.rows();
  const Eigen::Index count = std::max<Eigen::Index>(1, rows / std::max(kPieceRows, kPieceShape * p));
  if (p == 0) return Eigen::MatrixXd(rows, 0);
  if (rows < p) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> few(columns);
    return few.householderQ() * Eigen::MatrixXd::Identity(rows, few.rank());
  }
  const auto first = [&](Eigen::Index k) { return rows * k / count; };
  std::vector<Householder> pieces(static_cast<std::size_t>(count));
  Eigen::MatrixXd triangles(count * p, p);
  inParallel(pieces.size(), [&](std::size_t piece) {
    const Eigen::Index k = static_cast<Eigen::Index>(piece);
    pieces[piece].compute(columns.middleRows(first(k), first(k + 1) - first(k)));
    triangles.middleRows(k * p, p) = pieces[piece].matrixQR().topRows(p).triangularView<Eigen::Upper>();
  });
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> joined(triangles);
  const Eigen::MatrixXd inside = joined.householderQ() * Eigen::MatrixXd::Identity(triangles.rows(), joined.rank());
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(rows, joined.rank());
  inParallel(pieces.size(), [&](std::size_t piece) {
    const Eigen::Index k = static_cast<Eigen::Index>(piece);
    auto own = basis.middleRows(first(k), first(k + 1) - first(k));
    own.topRows(p) = inside.middleRows(k * p, p);
    own.applyOnTheLeft(pieces[piece].householderQ());
  });
  return basis;
}

Eigen::MatrixXd withPull(const Eigen::MatrixXd& columns, const Eigen::VectorXd& pull) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(columns.rows() + pull.size(), columns.cols());
  all.topRows(columns.rows()) = columns;
  all.bottomLeftCorner(pull.size(), pull.size()).diagonal() = pull;
  return all;
}

}  // namespace

void setAttention(TraceData& data, Attention attention) {
  data.scale = rowScale(data.stack, data.recordings, attention);
  data.base_rows = data.scale.asDiagonal() * data.all_base_rows;
  data.force_rows = data.scale.asDiagonal() * data.all_force_rows;
}

bool isWhole(const Hypothesis& h) {
  return !h.place.candidate->ofSize(h.shape, 1.0).empty();
}

std::vector<Hypothesis> without(std::vector<Hypothesis> all, std::size_t k) {
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(k));
  return all;
}

std::vector<Hypothesis> listHypotheses(const CandidateList& candidates, const std::vector<EffectInput>& inputs) {
  std::vector<Hypothesis> list;
  for (const auto& candidate : candidates) {
    if (candidate->needsTwoRecordings() && inputs.size() < 2) continue;
    if (!candidate->shared()) {
      for (int i = 0; i < inputs.front().axes(); ++i)
        addShapes(*candidate, inputs.front(), i, list);
      continue;
    }
    const std::size_t recordings = candidate->local() ? inputs.size() : 1;  // a window lies in one recording
    for (std::size_t r = 0; r < recordings; ++r)
      addShapes(*candidate, inputs[r], -1, list);
  }
  return list;
}

Eigen::MatrixXd effectColumns(const EffectInput& input, const Hypothesis& h, int actuator) {
  if (h.place.actsOnAll() && h.place.actuator >= 0)
    return h.place.candidate->reach(input, h.place.actuator, h.shape)[static_cast<std::size_t>(actuator)];
  if (h.place.actuator >= 0 && h.place.actuator != actuator) {
    return Eigen::MatrixXd::Zero(input.samples(),
                                 static_cast<Eigen::Index>(h.place.candidate->coefficients(input).size()));
  }
  return h.place.candidate->columns(input, actuator, h.shape);
}

std::vector<Eigen::MatrixXd> actingColumns(const EffectInput& input, const Hypothesis& h) {
  if (h.place.actuator < 0) return h.place.candidate->columnsOfAll(input, h.shape);
  if (h.place.actsOnAll()) return h.place.candidate->reach(input, h.place.actuator, h.shape);
  std::vector<Eigen::MatrixXd> own;
  own.push_back(h.place.candidate->columns(input, h.place.actuator, h.shape));
  return own;
}

Eigen::MatrixXd effectRows(const TraceData& data, const Hypothesis& h) {
  Eigen::Index first_row = 0;
  const Eigen::MatrixXd own = placeRows(data, {h}, first_row);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(data.stack.size() * data.stack.axes, own.cols());
  rows.middleRows(first_row, own.rows()) = data.scale.segment(first_row, own.rows()).asDiagonal() * own;
  return rows;
}

std::vector<Eigen::MatrixXd> effectRows(const TraceData& data, const std::vector<Hypothesis>& effects) {
  std::vector<Eigen::MatrixXd> rows(effects.size());
  inParallel(rows.size(), [&](std::size_t k) { rows[k] = effectRows(data, effects[k]); });
  return rows;
}

Eigen::MatrixXd weighted(const Stack& stack, Eigen::MatrixXd rows, const Eigen::VectorXd& noise_N) {
  for (int i = 0; i < stack.axes; ++i)
    rows.middleRows(i * stack.size(), stack.size()) /= noise_N[i];
  return rows;
}

Projection project(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force, const Eigen::VectorXd& pull) {
  Projection p;
  p.q = orthonormal(withPull(columns, pull)).topRows(columns.rows());
  p.residual = force - p.q * (p.q.transpose() * force);
  return p;
}

Eigen::VectorXd leftBy(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force, const Eigen::VectorXd& pull) {
  Eigen::VectorXd target = Eigen::VectorXd::Zero(force.size() + pull.size());
  target.head(force.size()) = force;
  const Eigen::MatrixXd triangle = identification::compress(withPull(columns, pull), target);
  const Eigen::Index p = columns.cols();
  return force - columns * triangle.leftCols(p).colPivHouseholderQr().solve(triangle.col(p));
}

Projector::Projector(const Eigen::MatrixXd& columns, const Eigen::VectorXd& force, const Eigen::VectorXd& pull)
    : force_(force) {
  const Eigen::MatrixXd all = withPull(columns, pull);
  basis_ = orthonormal(all);
  coordinates_ = basis_.transpose() * all;
}

Projection Projector::without(Eigen::Index from, Eigen::Index count) const {
  const Eigen::Index after = coordinates_.cols() - from - count;
  Eigen::MatrixXd others(coordinates_.rows(), from + after);
  others << coordinates_.leftCols(from), coordinates_.rightCols(after);
  Projection p;
  p.q = basis_.topRows(force_.size()) * orthonormal(others);
  p.residual = force_ - p.q * (p.q.transpose() * force_);
  return p;
}

Eigen::MatrixXd placeRows(const TraceData& data, const std::vector<Hypothesis>& tried, Eigen::Index& first_row) {
  const Eigen::Index p = data.stack.size();
  const Place& place = tried.front().place;
  const Eigen::Index each = static_cast<Eigen::Index>(place.candidate->coefficients(data.inputs.front()).size());
  const std::size_t acts_on = place.actsOnAll() ? static_cast<std::size_t>(data.stack.axes) : 1u;
  first_row = place.actsOnAll() ? 0 : place.actuator * p;
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(acts_on) * p, each * static_cast<Eigen::Index>(tried.size()));
  const std::size_t at_once =
      std::max<std::size_t>(1, kColumnsAtOnce / std::max<std::size_t>(1, static_cast<std::size_t>(each) * acts_on));
  for (std::size_t from = 0; from < tried.size(); from += at_once) {
    const std::size_t to = std::min(tried.size(), from + at_once);
    const Eigen::Index width = each * static_cast<Eigen::Index>(to - from);
    std::vector<std::vector<Eigen::MatrixXd>> columns(acts_on);  // of every recording
    for (const EffectInput& input : data.inputs) {
      for (std::vector<Eigen::MatrixXd>& own : columns)
        own.emplace_back(input.samples(), width);
      for (std::size_t k = from; k < to; ++k) {
        const std::vector<Eigen::MatrixXd> all = actingColumns(input, tried[k]);
        for (std::size_t i = 0; i < acts_on; ++i)
          columns[i].back().middleCols(static_cast<Eigen::Index>(k - from) * each, each) = all[i];
      }
    }
    for (std::size_t i = 0; i < acts_on; ++i)
      rows.block(static_cast<Eigen::Index>(i) * p, static_cast<Eigen::Index>(from) * each, p, width) =
          gather(data.stack, data.recordings, std::move(columns[i]));
  }
  return rows;
}

Probes makeProbes(const TraceData& data, const std::vector<Hypothesis>& tried, const Eigen::MatrixXd& rows,
                  Eigen::Index first_row, const Projection& projection, const Eigen::VectorXd& noise_N) {
  Probes probes;
  const Eigen::Index p = data.stack.size();
  const std::vector<Coefficient> coefficients = tried.front().place.candidate->coefficients(data.inputs.front());
  const Eigen::Index each = static_cast<Eigen::Index>(coefficients.size());
  probes.one_sign = each == 1 && coefficients.front().non_negative;
  probes.first_row = first_row;
  Eigen::VectorXd weight = data.scale.segment(first_row, rows.rows());
  for (Eigen::Index k = 0; k < weight.size(); ++k)
    weight[k] /= noise_N[(first_row + k) / p];
  probes.columns = weight.asDiagonal() * rows;
  const Eigen::MatrixXd shadow =
      projection.q.middleRows(probes.first_row, probes.columns.rows()).transpose() * probes.columns;
  for (std::size_t k = 0; k < tried.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k) * each;
    probes.survives.push_back(0.0);
    probes.inverse.push_back(
        inverseGram(probes.columns.middleCols(at, each), shadow.middleCols(at, each), probes.survives.back()));
  }
  return probes;
}

Probes makeProbes(const TraceData& data, const std::vector<Hypothesis>& tried, const Projection& projection,
                  const Eigen::VectorXd& noise_N) {
  Eigen::Index first_row = 0;
  const Eigen::MatrixXd rows = placeRows(data, tried, first_row);
  return makeProbes(data, tried, rows, first_row, projection, noise_N);
}

Eigen::MatrixXd explained(const Probes& probes, const Eigen::MatrixXd& residuals) {
  const Eigen::Index each = probes.columns.cols() / static_cast<Eigen::Index>(probes.inverse.size());
  const Eigen::MatrixXd all =
      probes.columns.transpose() * residuals.middleRows(probes.first_row, probes.columns.rows());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(probes.inverse.size()), residuals.cols());
  for (Eigen::Index k = 0; k < out.rows(); ++k) {
    const Eigen::MatrixXd& inverse = probes.inverse[static_cast<std::size_t>(k)];
    if (inverse.size() == 0) continue;
    const auto b = all.middleRows(k * each, each);
    out.row(k) = (inverse * b).cwiseProduct(b).colwise().sum();
    if (probes.one_sign) out.row(k) = (b.row(0).array() > 0.0).select(out.row(k), 0.0);
  }
  return out;
}

double explained(const TraceData& data, const Hypothesis& hypothesis, const Projection& projection,
                 const Eigen::VectorXd& noise_N) {
  return explained(makeProbes(data, {hypothesis}, projection, noise_N), projection.residual)(0, 0);
}

std::vector<std::vector<Hypothesis>> byPlace(const std::vector<Hypothesis>& tried) {
  std::vector<std::vector<Hypothesis>> groups;
  for (const Hypothesis& h : tried) {
    auto own = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.front().place == h.place; });
    if (own == groups.end()) own = groups.insert(groups.end(), std::vector<Hypothesis>());
    own->push_back(h);
  }
  return groups;
}

}  // namespace knee_robot::tracing
