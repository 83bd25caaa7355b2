#include "knee_robot/tracing/joint_fit.h"

#include <algorithm>
#include <limits>

#include "knee_robot/base/parallel.h"
#include "knee_robot/identification/reduction.h"

namespace knee_robot::tracing {
namespace {

/// Of a column's norm, without a block that had all of it: of what happens once all but a hundredth of its squares.
constexpr double kGone = 1e-6, kGoneOnce = 0.1;
constexpr int kFewestBlocks = 3;  ///< in which an effect must act for blocks that are left out to tell its spread

/// Where each column of the problem comes from, bounded ones first (`bounded` of them): effect (-1: base), column in it.
std::vector<std::pair<int, int>> sources(const BaseFit& base, const std::vector<Hypothesis>& effects,
                                         const std::vector<Eigen::MatrixXd>& rows, const EffectInput& input,
                                         int& bounded_count) {
  std::vector<std::pair<int, int>> source;
  for (const bool bounded : {true, false}) {
    for (int c = 0; c < base.coordinates(); ++c) {
      if ((c < base.bounded) == bounded) source.emplace_back(-1, c);
    }
    for (std::size_t e = 0; e < effects.size(); ++e) {
      const std::vector<Coefficient> coefficients = effects[e].place.candidate->coefficients(input);
      for (std::size_t c = 0; c < static_cast<std::size_t>(rows[e].cols()); ++c) {
        if (coefficients[c].non_negative == bounded) source.emplace_back(static_cast<int>(e), static_cast<int>(c));
      }
    }
    if (bounded) bounded_count = static_cast<int>(source.size());
  }
  return source;
}

identification::Equations equationsOf(const TraceData& data, const Eigen::VectorXd& noise_N,
                                      const std::vector<std::pair<int, int>>& source,
                                      const std::vector<Eigen::MatrixXd>& effect_rows) {
  identification::Equations e;
  e.axes = data.stack.axes;
  e.blocks = data.stack.blocks;
  e.a.resize(data.force_rows.size(), static_cast<Eigen::Index>(source.size()));
  e.b = data.force_rows;
  for (std::size_t c = 0; c < source.size(); ++c) {
    const auto [effect, column] = source[c];
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

/// Hat functions add up to a constant that the base has already; and a hat acts at one place: where that is left out
/// next to nothing of it may remain, from which its coefficient would be anything.
Eigen::VectorXd solve(const BlockProblem& problem, const Eigen::MatrixXd& triangle) {
  const Eigen::Index p = triangle.cols() - 1;
  const Eigen::VectorXd scale = triangle.leftCols(p).colwise().norm().transpose().cwiseMax(1e-12);
  const Eigen::Index pulls = static_cast<Eigen::Index>(problem.pulled.size());
  const Eigen::Index ones = static_cast<Eigen::Index>(problem.whole_effects.size());
  Eigen::MatrixXd scaled = Eigen::MatrixXd::Zero(triangle.rows() + pulls + ones + p, p);
  Eigen::VectorXd target = Eigen::VectorXd::Zero(scaled.rows());
  scaled.bottomRows(p).diagonal() = problem.prior.cwiseQuotient(scale);
  scaled.topRows(triangle.rows()) = triangle.leftCols(p) * scale.cwiseInverse().asDiagonal();
  target.head(triangle.rows()) = triangle.col(p);
  for (Eigen::Index k = 0; k < pulls; ++k) {
    const int column = problem.pulled[static_cast<std::size_t>(k)];
    scaled(triangle.rows() + k, column) = kPull * std::max(1.0, problem.whole[column] / scale[column]);
  }
  for (Eigen::Index k = 0; k < ones; ++k) {
    const int column = problem.whole_effects[static_cast<std::size_t>(k)];
    scaled(triangle.rows() + pulls + k, column) = kPullToWhole;
    target[triangle.rows() + pulls + k] = kPullToWhole * scale[column];
  }
  return identification::boundedLeastSquares(scaled, target, problem.bounded).cwiseQuotient(scale);
}

/// The settings of these columns only, without blocks.
BlockProblem settingsOf(const BlockProblem& all, const std::vector<int>& columns) {
  BlockProblem some;
  some.whole = all.whole(columns);
  some.prior = all.prior(columns);
  some.own = all.own(columns);
  for (const int column : columns)
    some.once.push_back(all.once[static_cast<std::size_t>(column)]);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c] < all.bounded) ++some.bounded;
    if (std::find(all.pulled.begin(), all.pulled.end(), columns[c]) != all.pulled.end())
      some.pulled.push_back(static_cast<int>(c));
    if (std::find(all.whole_effects.begin(), all.whole_effects.end(), columns[c]) != all.whole_effects.end())
      some.whole_effects.push_back(static_cast<int>(c));
  }
  return some;
}

/// The problem with these columns only.
BlockProblem only(const BlockProblem& all, const std::vector<int>& columns) {
  BlockProblem some = settingsOf(all, columns);
  std::vector<int> of_block = columns;
  of_block.push_back(static_cast<int>(all.whole.size()));  // the force
  for (const Eigen::MatrixXd& block : all.blocks)
    some.blocks.push_back(block(Eigen::all, of_block));
  return some;
}

/// Columns of which something is left in `triangle`, without a block.
std::vector<int> leftIn(const BlockProblem& problem, const Eigen::MatrixXd& triangle) {
  std::vector<int> columns;
  for (int c = 0; c < static_cast<int>(problem.own.size()); ++c) {
    const double gone = problem.once[static_cast<std::size_t>(c)] ? kGoneOnce : kGone;
    if (problem.own[c] == 0.0 || triangle.col(c).norm() > gone * problem.own[c]) columns.push_back(c);
  }
  return columns;
}

/// A push happens in one block, as it may be, and without that its size would be anything: it is what it is with all
/// blocks, whichever is left out: what is asked of the other effects does not depend on it then. Of any other effect
/// that a block had alone nothing is known without it.
Eigen::VectorXd solveWithout(const BlockProblem& problem, const Eigen::MatrixXd& triangle, const Eigen::VectorXd& all) {
  const std::vector<int> columns = leftIn(problem, triangle);
  if (static_cast<Eigen::Index>(columns.size()) == problem.own.size()) return solve(problem, triangle);
  const BlockProblem some = settingsOf(problem, columns);
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(all.size());
  for (Eigen::Index c = 0; c < all.size(); ++c)
    solution[c] = problem.once[static_cast<std::size_t>(c)] ? all[c] : 0.0;
  solution(columns).setZero();
  Eigen::MatrixXd rest(triangle.rows(), static_cast<Eigen::Index>(columns.size()) + 1);
  rest << triangle(Eigen::all, columns), triangle.rightCols<1>() - triangle.leftCols(all.size()) * solution;
  solution(columns) = solve(some, rest);
  return solution;
}

/// Solutions without each block (columns), and the squares that each leaves in its block.
Eigen::MatrixXd leaveOutEach(const BlockProblem& problem, Eigen::VectorXd& held_back) {
  const std::vector<Eigen::MatrixXd> others = identification::joinOthers(problem.blocks);
  const Eigen::Index p = others.front().cols() - 1;
  Eigen::VectorXd all;
  const bool gone = std::any_of(others.begin(), others.end(), [&](const Eigen::MatrixXd& triangle) {
    return static_cast<Eigen::Index>(leftIn(problem, triangle).size()) < p;
  });
  if (gone) all = solve(problem, identification::joinBlocks(problem.blocks, -1));
  Eigen::MatrixXd solutions(p, static_cast<Eigen::Index>(others.size()));
  held_back.resize(solutions.cols());
  inParallel(others.size(), [&](std::size_t block) {
    const Eigen::Index b = static_cast<Eigen::Index>(block);
    solutions.col(b) = solveWithout(problem, others[block], all);
    const Eigen::MatrixXd& own = problem.blocks[block];
    held_back[b] = own.rows() == 0 ? 0.0 : (own.rightCols(1) - own.leftCols(p) * solutions.col(b)).squaredNorm();
  });
  return solutions;
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

JointProblem::JointProblem(const TraceData& data, const BaseFit& base, const Eigen::VectorXd& noise_N,
                           const std::vector<Hypothesis>& effects, std::vector<Eigen::MatrixXd> effect_rows)
    : data_(data),
      noise_N_(noise_N),
      effect_rows_(std::move(effect_rows)),
      source_(sources(base, effects, effect_rows_, data.inputs.front(), problem_.bounded)),
      equations_(equationsOf(data, noise_N, source_, effect_rows_)) {
  problem_.blocks = identification::compressBlocks(equations_);
  const Eigen::MatrixXd all = identification::joinBlocks(problem_.blocks, -1);
  problem_.whole = all.leftCols(all.cols() - 1).colwise().norm();
  problem_.prior = Eigen::VectorXd::Zero(problem_.whole.size());
  problem_.own = problem_.prior;
  for (std::size_t c = 0; c < source_.size(); ++c) {
    const auto [effect, column] = source_[c];
    const Eigen::Index at = static_cast<Eigen::Index>(c);
    const std::size_t k = static_cast<std::size_t>(std::max(0, effect));
    if (effect < 0) problem_.prior[at] = base.pull[column];
    const bool is_map = effect >= 0 && effects[k].place.candidate->isMap();
    if (effect >= 0 && !is_map) problem_.own[at] = problem_.whole[at];
    if (!is_map) problem_.whole[at] = 0.0;
    problem_.once.push_back(effect >= 0 && effects[k].place.candidate->local());
    if (effect >= 0 && effects[k].place.candidate->isPulled(effect_rows_[k].cols()))
      problem_.pulled.push_back(static_cast<int>(c));
    if (effect >= 0 && isWhole(effects[k])) problem_.whole_effects.push_back(static_cast<int>(c));
  }
}

JointFit JointProblem::fit(LeftOut wanted) const {
  const Eigen::VectorXd z = solve(problem_, identification::joinBlocks(problem_.blocks, -1));
  JointFit fit;
  fit.residual_N = equations_.b - equations_.a * z;
  for (int i = 0; i < equations_.axes; ++i)
    fit.residual_N.segment(i * data_.stack.size(), data_.stack.size()) *= noise_N_[i];
  const int blocks = equations_.blocks;
  Eigen::MatrixXd left_out = Eigen::MatrixXd::Constant(z.size(), blocks, std::numeric_limits<double>::quiet_NaN());
  if (wanted == LeftOut::EveryBlock) left_out = leaveOutEach(problem_, fit.held_back);
  const Eigen::VectorXd spread =
      ((left_out.colwise() - left_out.rowwise().mean()).rowwise().squaredNorm() * (blocks - 1.0) / blocks).cwiseSqrt();
  fit.base.resize(std::count_if(source_.begin(), source_.end(), [](const auto& from) { return from.first < 0; }));
  fit.base_std.resize(fit.base.size());
  for (const Eigen::MatrixXd& rows : effect_rows_) {
    fit.coefficients.push_back(Eigen::VectorXd::Zero(rows.cols()));
    fit.std.push_back(Eigen::VectorXd::Zero(rows.cols()));
  }
  fit.stable.assign(effect_rows_.size(), 1);
  for (std::size_t c = 0; c < source_.size(); ++c) {
    const auto [effect, column] = source_[c];
    const Eigen::Index at = static_cast<Eigen::Index>(c);
    if (effect < 0) {
      fit.base[column] = z[at];
      fit.base_std[column] = spread[at];
      continue;
    }
    const std::size_t k = static_cast<std::size_t>(effect);
    fit.coefficients[k][column] = z[at];
    fit.std[k][column] = spread[at];
    if (effect_rows_[k].cols() == 1 && (left_out.row(at).array() * z[at] <= 0.0).any()) fit.stable[k] = 0;
  }
  for (std::size_t k = 0; k < effect_rows_.size(); ++k) {
    if (blocksOf(data_, effect_rows_[k]) < kFewestBlocks)
      fit.std[k].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return fit;
}

Eigen::VectorXd JointProblem::heldBack() const {
  Eigen::VectorXd held_back;
  leaveOutEach(problem_, held_back);
  return held_back;
}

Eigen::VectorXd JointProblem::heldBackWithout(std::size_t k) const {
  std::vector<int> columns;
  for (std::size_t c = 0; c < source_.size(); ++c) {
    if (source_[c].first != static_cast<int>(k)) columns.push_back(static_cast<int>(c));
  }
  Eigen::VectorXd held_back;
  leaveOutEach(only(problem_, columns), held_back);
  return held_back;
}

}  // namespace knee_robot::tracing
