#include "knee_robot/tracing/base_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/rank.h"
#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {
namespace {

const double kWidths[] = {0.5, 1.0, 2.0, 4.0};    ///< encoder counts
const double kMemoryCutoffs[] = {3.0, 8.0, 0.0};  ///< times the cut-off; 0: no low-pass
constexpr double kFine_m =
    2e-5;  ///< tried for finer encoders too: the filters' ringing moves an axis at rest by microns
constexpr int kFewestSamples = 100;

/// All rows as identification's equations, weighted by the noise; force less that of `start` and of effects.
identification::Equations equationsOf(const std::vector<identification::Observation>& training, const Stack& stack,
                                      const Eigen::VectorXd& noise_N, const Eigen::VectorXd& start,
                                      const Eigen::VectorXd& effects_N) {
  identification::Equations e;
  e.axes = stack.axes;
  e.blocks = stack.blocks;
  const Eigen::Index p = training.front().regressor.front().cols();
  e.a.resize(stack.size() * stack.axes, p);
  e.b.resize(stack.size() * stack.axes);
  for (int i = 0; i < stack.axes; ++i) {
    std::vector<Eigen::MatrixXd> columns;
    for (const identification::Observation& o : training)
      columns.push_back(o.regressor[static_cast<std::size_t>(i)]);
    e.a.middleRows(i * stack.size(), stack.size()) = gather(stack, training, std::move(columns));
    e.b.segment(i * stack.size(), stack.size()) = gatherForce(stack, training, i);
    for (const Pick& pick : stack.picks) {
      e.actuator.push_back(i);
      e.block.push_back(pick.block);
    }
  }
  e.b -= e.a * start;
  if (effects_N.size() > 0) e.b -= effects_N;
  identification::weightRows(e, noise_N);
  const Eigen::VectorXd scale = rowScale(stack, training, Attention::Moving);  // rest would blur the base directions
  e.a = scale.asDiagonal() * e.a;
  e.b = scale.cwiseProduct(e.b);
  return e;
}

Eigen::VectorXd solve(const identification::Equations& e, BaseFit& base, int rank) {
  const std::vector<char> use(base.columns.size(), 1);
  int chosen = rank;
  if (chosen == 0) {  // the best one, not the most parsimonious: an effect must not stand in for a base direction
    const std::vector<identification::RankPoint> curve = identification::chooseRank(e, base.columns, use).curve;
    chosen = std::min_element(curve.begin(), curve.end(),
                              [](const identification::RankPoint& a, const identification::RankPoint& b) {
                                return a.held_back < b.held_back;
                              })
                 ->rank;
  }
  const identification::Reduction r = identification::reduce(
      identification::joinBlocks(identification::compressBlocks(e), -1), e.rows(), base.columns, use);
  const int kept = std::clamp(chosen, r.minimalRank(), r.maximalRank());
  base.bounded = r.minimalRank();
  base.basis.resize(static_cast<Eigen::Index>(base.columns.size()), kept);
  for (int k = 0; k < kept; ++k)
    base.basis.col(k) = identification::toParameters(r, Eigen::VectorXd::Unit(kept, k));
  const Eigen::VectorXd correction = identification::toParameters(r, identification::solveReduced(r, kept));
  base.parameters = base.start + correction;
  return e.b - e.a * correction;
}

std::vector<FrictionMemory> memories(const mechanism::Actuator& actuator, double cutoff_hz) {
  std::vector<FrictionMemory> all;
  for (const double factor : kMemoryCutoffs) {
    for (const double counts : kWidths)
      all.push_back({counts * actuator.metresPerCount(), factor * cutoff_hz});
    if (kWidths[3] * actuator.metresPerCount() < kFine_m) all.push_back({kFine_m, factor * cutoff_hz});
  }
  return all;
}

}  // namespace

void chooseMemory(const mechanism::Robot& robot, std::vector<identification::Observation>& training, const Stack& stack,
                  const Eigen::VectorXd& residual_N, BaseFit& base) {
  for (int i = 0; i < stack.axes; ++i) {
    const std::size_t axis = static_cast<std::size_t>(i);
    const auto column = std::find_if(base.columns.begin(), base.columns.end(), [&](const identification::Column& c) {
      return c.role == identification::ColumnRole::Coulomb && c.actuator == i;
    });
    const double coulomb = base.parameters[column - base.columns.begin()];
    std::vector<Eigen::MatrixXd> now, velocity;
    for (const identification::Observation& o : training) {
      now.push_back(frictionShare(o, i, base.memory[axis]));
      velocity.push_back(o.signals.velocity_m_per_s.col(i));
    }
    Eigen::MatrixXd design(stack.size(), 3);
    const Eigen::VectorXd target =
        residual_N.segment(i * stack.size(), stack.size()) + coulomb * gather(stack, training, now).col(0);
    design.col(0) = gather(stack, training, velocity);
    design.col(1).setOnes();
    double least = std::numeric_limits<double>::infinity();
    for (const FrictionMemory& memory : memories(robot.actuators[axis], stack.cutoff_hz)) {
      std::vector<Eigen::MatrixXd> share;
      for (const identification::Observation& o : training)
        share.push_back(frictionShare(o, i, memory));
      design.col(2) = gather(stack, training, share);
      const Eigen::VectorXd own = (design.transpose() * design).ldlt().solve(design.transpose() * target);
      const double left = (target - design * own).squaredNorm();
      if (left >= least) continue;
      least = left;
      base.memory[axis] = memory;
    }
  }
  for (identification::Observation& o : training)
    setFriction(o, base.columns, base.memory);
}

BaseFit fitBase(const mechanism::Robot& robot, std::vector<identification::Observation>& training, const Stack& stack,
                const std::vector<identification::Column>& columns, int rank, const Eigen::VectorXd* given,
                const Eigen::VectorXd& effects_N) {
  if (stack.size() < kFewestSamples) {
    throw Refusal("only " + std::to_string(stack.size()) + " usable samples in the training recordings (at least " +
                  std::to_string(kFewestSamples) + " are needed): record a longer motion, away from singular poses");
  }
  BaseFit base;
  base.columns = columns;
  for (const mechanism::Actuator& a : robot.actuators)
    base.memory.push_back({a.metresPerCount(), 3.0 * stack.cutoff_hz});
  base.start = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
  if (given != nullptr) {
    base.start = *given;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (columns[c].isNonNegative()) base.start[static_cast<Eigen::Index>(c)] = 0.0;
    }
  }
  for (identification::Observation& o : training)
    setFriction(o, columns, base.memory);
  base.noise_N = Eigen::VectorXd::Ones(stack.axes);
  identification::Equations e = equationsOf(training, stack, base.noise_N, base.start, effects_N);
  base.noise_N = identification::rmsPerActuator(e, e.b).cwiseMax(1e-6);
  identification::weightRows(e, base.noise_N);
  Eigen::VectorXd residual = solve(e, base, rank);
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < stack.axes; ++i)
      residual.segment(i * stack.size(), stack.size()) *= base.noise_N[i];
    base.noise_N = identification::rmsPerActuator(e, residual).cwiseMax(1e-6);
    const Eigen::VectorXd scale = rowScale(stack, training, Attention::Moving);
    if (pass == 0) chooseMemory(robot, training, stack, residual.cwiseQuotient(scale), base);
    e = equationsOf(training, stack, base.noise_N, base.start, effects_N);
    residual = solve(e, base, rank);
  }
  return base;
}

Eigen::MatrixXd baseRows(const BaseFit& base, const std::vector<identification::Observation>& recordings,
                         const Stack& stack) {
  Eigen::MatrixXd rows(stack.size() * stack.axes, base.rank());
  for (int i = 0; i < stack.axes; ++i) {
    std::vector<Eigen::MatrixXd> columns;
    for (const identification::Observation& o : recordings)
      columns.push_back(o.regressor[static_cast<std::size_t>(i)] * base.basis);
    rows.middleRows(i * stack.size(), stack.size()) = gather(stack, recordings, std::move(columns)) / base.noise_N[i];
  }
  return rows;
}

Eigen::VectorXd forceRows(const BaseFit& base, const std::vector<identification::Observation>& recordings,
                          const Stack& stack) {
  Eigen::VectorXd rows(stack.size() * stack.axes);
  for (int i = 0; i < stack.axes; ++i) {
    std::vector<Eigen::MatrixXd> known;
    for (const identification::Observation& o : recordings)
      known.push_back(o.regressor[static_cast<std::size_t>(i)] * base.start);
    rows.segment(i * stack.size(), stack.size()) =
        (gatherForce(stack, recordings, i) - gather(stack, recordings, std::move(known))) / base.noise_N[i];
  }
  return rows;
}

Eigen::VectorXd rmsRows(const BaseFit& base, const Stack& stack, const Eigen::VectorXd& rows) {
  Eigen::VectorXd rms(stack.axes);
  for (int i = 0; i < stack.axes; ++i)
    rms[i] = base.noise_N[i] * rows.segment(i * stack.size(), stack.size()).norm() / std::sqrt(double(stack.size()));
  return rms;
}

}  // namespace knee_robot::tracing
