#include "knee_robot/tracing/joint_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/parallel.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::tracing {
namespace {

constexpr double kPull = 0.02;    ///< relative to a column's norm
constexpr int kFewestBlocks = 3;  ///< in which an effect must act for blocks that are left out to tell its spread

/// Where each column of the problem comes from: bounded ones first.
struct Layout {
  std::vector<std::pair<int, int>> source;  ///< effect (-1: base), column in it
  int bounded = 0;
};

Layout layoutOf(const BaseFit& base, const std::vector<Hypothesis>& effects, const EffectInput& input) {
  Layout layout;
  for (const bool bounded : {true, false}) {
    for (int c = 0; c < base.coordinates(); ++c) {
      if ((c < base.bounded) == bounded) layout.source.emplace_back(-1, c);
    }
    for (std::size_t e = 0; e < effects.size(); ++e) {
      const std::vector<Coefficient> coefficients = effects[e].place.candidate->coefficients(input);
      for (std::size_t c = 0; c < coefficients.size(); ++c) {
        if (coefficients[c].non_negative == bounded)
          layout.source.emplace_back(static_cast<int>(e), static_cast<int>(c));
      }
    }
    if (bounded) layout.bounded = static_cast<int>(layout.source.size());
  }
  return layout;
}

identification::Equations equationsOf(const TraceData& data, const Eigen::VectorXd& noise_N, const Layout& layout,
                                      const std::vector<Eigen::MatrixXd>& effect_rows) {
  identification::Equations e;
  e.axes = data.stack.axes;
  e.blocks = data.stack.blocks;
  e.a.resize(data.force_rows.size(), static_cast<Eigen::Index>(layout.source.size()));
  e.b = data.force_rows;
  for (std::size_t c = 0; c < layout.source.size(); ++c) {
    const auto [effect, column] = layout.source[c];
    e.a.col(static_cast<Eigen::Index>(c)) =
        effect < 0 ? data.base_rows.col(column) : effect_rows[static_cast<std::size_t>(effect)].col(column);
  }
  for (int i = 0; i < e.axes; ++i) {
    for (const Pick& pick : data.stack.picks) {
      e.actuator.push_back(i);
      e.block.push_back(pick.block);
    }
  }
  identification::weightRows(e, noise_N);
  return e;
}

/// `groups`: columns of effects with several coefficients, which get a slight pull to zero: hat functions add up to a
/// constant that the base has already. `whole`: norms with all blocks of the columns of maps, else 0: a hat acts at one
/// place, and where that is left out next to nothing of it may remain, from which its coefficient would be anything.
/// `prior`: per column, root of the weight of a pull to zero.
Eigen::VectorXd solve(const Eigen::MatrixXd& triangle, int bounded, const std::vector<int>& groups,
                      const Eigen::VectorXd& whole, const Eigen::VectorXd& prior) {
  const Eigen::Index p = triangle.cols() - 1;
  const Eigen::VectorXd scale = triangle.leftCols(p).colwise().norm().transpose().cwiseMax(1e-12);
  const Eigen::Index pulls = static_cast<Eigen::Index>(groups.size());
  Eigen::MatrixXd scaled = Eigen::MatrixXd::Zero(triangle.rows() + pulls + p, p);
  Eigen::VectorXd target = Eigen::VectorXd::Zero(scaled.rows());
  scaled.bottomRows(p).diagonal() = prior.cwiseQuotient(scale);
  scaled.topRows(triangle.rows()) = triangle.leftCols(p) * scale.cwiseInverse().asDiagonal();
  target.head(triangle.rows()) = triangle.col(p);
  for (Eigen::Index k = 0; k < pulls; ++k) {
    const int column = groups[static_cast<std::size_t>(k)];
    scaled(triangle.rows() + k, column) = kPull * std::max(1.0, whole[column] / scale[column]);
  }
  return identification::boundedLeastSquares(scaled, target, bounded).cwiseQuotient(scale);
}

/// Blocks in which an effect does anything.
int blocksOf(const TraceData& data, const Eigen::MatrixXd& rows) {
  std::vector<char> acts(static_cast<std::size_t>(data.stack.blocks), 0);
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const Pick& pick = data.stack.picks[static_cast<std::size_t>(row % data.stack.size())];
    if (!rows.row(row).isZero(0.0)) acts[static_cast<std::size_t>(pick.block)] = 1;
  }
  return static_cast<int>(std::count(acts.begin(), acts.end(), 1));
}

}  // namespace

JointFit fitJointly(const TraceData& data, const BaseFit& base, const Eigen::VectorXd& noise_N,
                    const std::vector<Hypothesis>& effects, const std::vector<Eigen::MatrixXd>& effect_rows,
                    LeftOut wanted) {
  const Layout layout = layoutOf(base, effects, data.inputs.front());
  const identification::Equations e = equationsOf(data, noise_N, layout, effect_rows);
  const std::vector<Eigen::MatrixXd> blocks = identification::compressBlocks(e);
  std::vector<int> groups;
  for (std::size_t c = 0; c < layout.source.size(); ++c) {
    const int effect = layout.source[c].first;
    if (effect >= 0 && effect_rows[static_cast<std::size_t>(effect)].cols() > 2) groups.push_back(static_cast<int>(c));
  }
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.source.size()));
  for (std::size_t c = 0; c < layout.source.size(); ++c) {
    if (layout.source[c].first < 0) prior[static_cast<Eigen::Index>(c)] = base.pull[layout.source[c].second];
  }
  const Eigen::MatrixXd all = identification::joinBlocks(blocks, -1);
  Eigen::VectorXd whole = all.leftCols(all.cols() - 1).colwise().norm();
  for (std::size_t c = 0; c < layout.source.size(); ++c) {
    const int effect = layout.source[c].first;
    if (effect < 0 || !effects[static_cast<std::size_t>(effect)].place.candidate->isMap())
      whole[static_cast<Eigen::Index>(c)] = 0.0;
  }
  const Eigen::VectorXd z = solve(all, layout.bounded, groups, whole, prior);
  JointFit fit;
  fit.residual_N = e.b - e.a * z;
  for (int i = 0; i < e.axes; ++i)
    fit.residual_N.segment(i * data.stack.size(), data.stack.size()) *= noise_N[i];
  Eigen::MatrixXd left_out = Eigen::MatrixXd::Constant(z.size(), e.blocks, std::numeric_limits<double>::quiet_NaN());
  if (wanted == LeftOut::EveryBlock) {
    fit.held_back.resize(e.blocks);
    const std::vector<Eigen::MatrixXd> others = identification::joinOthers(blocks);
    inParallel(blocks.size(), [&](std::size_t block) {
      const Eigen::Index b = static_cast<Eigen::Index>(block);
      left_out.col(b) = solve(others[block], layout.bounded, groups, whole, prior);
      const Eigen::MatrixXd& own = blocks[block];
      fit.held_back[b] =
          own.rows() == 0 ? 0.0 : (own.rightCols(1) - own.leftCols(z.size()) * left_out.col(b)).squaredNorm();
    });
  }
  const Eigen::VectorXd spread =
      ((left_out.colwise() - left_out.rowwise().mean()).rowwise().squaredNorm() * (e.blocks - 1.0) / e.blocks)
          .cwiseSqrt();
  fit.base.resize(base.coordinates());
  fit.base_std.resize(base.coordinates());
  for (const Eigen::MatrixXd& rows : effect_rows) {
    fit.coefficients.push_back(Eigen::VectorXd::Zero(rows.cols()));
    fit.std.push_back(Eigen::VectorXd::Zero(rows.cols()));
  }
  fit.stable.assign(effects.size(), 1);
  for (std::size_t c = 0; c < layout.source.size(); ++c) {
    const auto [effect, column] = layout.source[c];
    const Eigen::Index at = static_cast<Eigen::Index>(c);
    if (effect < 0) {
      fit.base[column] = z[at];
      fit.base_std[column] = spread[at];
      continue;
    }
    const std::size_t k = static_cast<std::size_t>(effect);
    fit.coefficients[k][column] = z[at];
    fit.std[k][column] = spread[at];
    if (effect_rows[k].cols() == 1 && (left_out.row(at).array() * z[at] <= 0.0).any()) fit.stable[k] = 0;
  }
  for (std::size_t k = 0; k < effect_rows.size(); ++k) {
    if (blocksOf(data, effect_rows[k]) < kFewestBlocks)
      fit.std[k].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return fit;
}

}  // namespace knee_robot::tracing
