#include "knee_robot/identification/identify.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/identification/robust_fit.h"

namespace knee_robot::identification {
namespace {

constexpr double kShortestMotion_s = 2.0;
constexpr double kMostSaturated = 0.2;  ///< of the samples
constexpr double kDetermined = 0.99;    ///< share of a parameter's own direction that the kept directions must contain
constexpr double kWellKnown = 0.1;      ///< relative standard error of an identified parameter

std::string namesOf(const std::vector<Observation>& training) {
  std::string names;
  for (const Observation& o : training)
    names += (names.empty() ? "" : ", ") + o.path;
  return names;
}

void refuseSaturated(const std::vector<Observation>& training) {
  for (const Observation& o : training) {
    if (o.saturated_share <= kMostSaturated) continue;
    throw Refusal(o.path + ": a command is at its limit in " + shortNumber(100.0 * o.saturated_share, 3) +
                  " % of the samples (at most 20 % are tolerated), so the forces are not what was asked for; record a "
                  "gentler motion");
  }
}

void refuseMotionless(const std::vector<Observation>& training, const ObservationOptions& options) {
  const int axes = training.front().axes();
  for (int i = 0; i < axes; ++i) {
    double fastest = 0.0;
    for (const Observation& o : training) {
      fastest = std::max(fastest, o.signals.velocity_m_per_s.col(i).cwiseAbs().maxCoeff());
    }
    if (fastest > options.moving_m_per_s) continue;
    throw Refusal("actuator " + std::to_string(i + 1) + " never moves faster than " + shortNumber(1e3 * fastest, 3) +
                  " mm/s in " + namesOf(training) + " (moving means more than " +
                  shortNumber(1e3 * options.moving_m_per_s, 3) + " mm/s); record a motion of all actuators");
  }
}

void refuseTooShort(const std::vector<Observation>& training, const Equations& e, const ObservationOptions& options) {
  if (e.duration_s >= kShortestMotion_s && e.blocks >= 2) return;
  throw Refusal("only " + shortNumber(e.duration_s, 3) + " s of usable motion in " + namesOf(training) +
                " (all axes faster than " + shortNumber(1e3 * options.moving_m_per_s, 3) +
                " mm/s, no gap, singular pose or saturation); at least " + shortNumber(kShortestMotion_s) +
                " s are needed: record a longer motion");
}

void refuseRank(int asked, const Reduction& r, const std::vector<Observation>& training) {
  if (asked == 0) return;
  if (asked < r.minimalRank()) {
    throw InputError("rank " + std::to_string(asked) + " is too small: friction and rotor inertia alone are " +
                     std::to_string(r.minimalRank()) + " parameters, and are never truncated; ask for at least that");
  }
  if (asked > r.maximalRank()) {
    throw Refusal(std::to_string(asked) + " directions were asked for, but " + namesOf(training) + " excites only " +
                  std::to_string(r.maximalRank()) + "; ask for fewer, or record a richer motion");
  }
}

std::vector<char> usedColumns(const std::vector<Column>& columns, bool friction) {
  std::vector<char> use(columns.size(), 1);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].isFriction() && !friction) use[c] = 0;
  }
  return use;
}

std::vector<int> coulombColumns(const std::vector<Column>& columns) {
  std::vector<int> list;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].role == ColumnRole::Coulomb) list.push_back(static_cast<int>(c));
  }
  return list;
}

/// The equations unweighted, and what is fitted to them at one rank.
struct Stage {
  Equations equations;  ///< weighted with noise_N
  Eigen::VectorXd noise_N;
  RankChoice rank;
  Eigen::VectorXd parameters;
};

Reduction reductionOf(const Equations& e, const std::vector<Column>& columns, const std::vector<char>& use) {
  return reduce(joinBlocks(compressBlocks(e), -1), e.rows(), columns, use);
}

/// Weights with `noise_N`, chooses the rank (unless it is given), solves.
Stage solveStage(Equations equations, const Eigen::VectorXd& noise_N, const std::vector<Column>& columns,
                 const std::vector<char>& use, int given_rank) {
  Stage s;
  s.noise_N = noise_N;
  s.equations = std::move(equations);
  weightRows(s.equations, noise_N);
  s.rank = chooseRank(s.equations, columns, use);
  const Reduction r = reductionOf(s.equations, columns, use);
  if (given_rank > 0) s.rank.rank = std::clamp(given_rank, r.minimalRank(), r.maximalRank());
  s.parameters = toParameters(r, solveReduced(r, s.rank.rank));
  return s;
}

Eigen::VectorXd noiseAfter(const Equations& unweighted, const Eigen::VectorXd& parameters) {
  const Eigen::VectorXd rms = rmsPerActuator(unweighted, unweighted.b - unweighted.a * parameters);
  return rms.cwiseMax(1e-6 * std::max(1e-6, rms.maxCoeff()));  // an exact fit must not divide by zero
}

/// Share of column c's own direction that lies in the kept directions (1: determined alone).
double determinedShare(const Reduction& r, std::size_t other, int directions) {
  return r.directions.row(static_cast<Eigen::Index>(other)).head(directions).squaredNorm();
}

std::string verdictOf(double value, double std) {
  return std < kWellKnown * std::abs(value) ? "identified" : "weakly identified";
}

void describeParameters(const Reduction& r, const RobustFit& fit, const std::vector<Column>& columns,
                        dynamics::Model& model) {
  const Eigen::VectorXd values = toParameters(r, fit.coordinates);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    dynamics::ModelParameter p;
    p.name = columns[c].name;
    p.unit = columns[c].unit;
    p.value = values[static_cast<Eigen::Index>(c)];
    model.parameters.push_back(p);
  }
  const int kept = r.minimalRank();
  for (int i = 0; i < kept; ++i) {
    const int c = r.kept[static_cast<std::size_t>(i)];
    dynamics::ModelParameter& p = model.parameters[static_cast<std::size_t>(c)];
    p.std = std::sqrt(std::max(0.0, fit.covariance(i, i))) / r.scale[c];
    p.verdict = p.value > 0.0 ? verdictOf(p.value, p.std) : "at its bound";
  }
  const int directions = static_cast<int>(fit.coordinates.size()) - kept;
  for (std::size_t k = 0; k < r.others.size(); ++k) {
    if (directions == 0 || determinedShare(r, k, directions) < kDetermined) continue;
    const Eigen::VectorXd row = r.directions.row(static_cast<Eigen::Index>(k)).head(directions).transpose();
    dynamics::ModelParameter& p = model.parameters[static_cast<std::size_t>(r.others[k])];
    p.std = std::sqrt(std::max(0.0, row.dot(fit.covariance.bottomRightCorner(directions, directions) * row))) /
            r.scale[r.others[k]];
    p.verdict = verdictOf(p.value, p.std);
  }
  for (int d = 0; d < directions; ++d) {
    dynamics::BaseParameter base;
    base.value = fit.coordinates[kept + d];
    base.std = std::sqrt(std::max(0.0, fit.covariance(kept + d, kept + d)));
    base.weights.assign(columns.size(), 0.0);
    for (std::size_t k = 0; k < r.others.size(); ++k) {
      const std::size_t c = static_cast<std::size_t>(r.others[k]);
      base.weights[c] = r.directions(static_cast<Eigen::Index>(k), d) * r.scale[r.others[k]];
    }
    model.base.push_back(base);
  }
}

void describeModel(const mechanism::Robot& robot, const std::vector<Observation>& training,
                   const ObservationOptions& options, dynamics::Model& model) {
  model.kind = robot.kind;
  model.axes = robot.axes();
  model.robot_fingerprint = robot.fingerprint;
  model.cutoff_hz = options.cutoff_hz;
  model.moving_m_per_s = options.moving_m_per_s;
  for (const Observation& o : training)
    model.data.push_back({o.path, o.fingerprint});
}

/// What the physically consistent fit needs of the equations.
void keepBlocks(Equations& e, const Eigen::VectorXd& weights, Identification& id) {
  const Eigen::VectorXd root = weights.cwiseSqrt();
  e.a.array().colwise() *= root.array();
  e.b.array() *= root.array();
  id.compressed = compressBlocks(e);
  id.block_rows.assign(static_cast<std::size_t>(e.blocks), 0);
  for (const int block : e.block)
    ++id.block_rows[static_cast<std::size_t>(block)];
}

}  // namespace

Identification identify(const mechanism::Robot& robot, std::vector<Observation>& training,
                        const IdentifyOptions& options) {
  Identification id;
  id.columns = columnsOf(robot, options.joint_friction);
  refuseMotionless(training, options.observation);
  refuseSaturated(training);
  const std::vector<char> use = usedColumns(id.columns, options.friction);

  // First with narrow friction steps and weights from the forces' own size, then with what that fit says about both.
  std::vector<double> widths = narrowestCoulombWidths(robot, options.narrowest_counts);
  for (Observation& o : training)
    setCoulombWidth(o, id.columns, widths);
  Equations equations = stackEquations(training, options.observation);
  refuseTooShort(training, equations, options.observation);
  Stage stage = solveStage(equations, noiseAfter(equations, Eigen::VectorXd::Zero(equations.a.cols())), id.columns, use,
                           options.rank);
  if (options.friction) {
    widths = chooseCoulombWidths(robot, id.columns, training, stage.parameters, options);
    for (Observation& o : training)
      setCoulombWidth(o, id.columns, widths);
    refillColumns(training, options.observation, coulombColumns(id.columns), equations);
  }
  if (options.friction) refuseRank(options.rank, reductionOf(stage.equations, id.columns, use), training);
  stage = solveStage(equations, noiseAfter(equations, stage.parameters), id.columns, use, options.rank);
  stage = solveStage(equations, noiseAfter(equations, stage.parameters), id.columns, use, options.rank);

  const Reduction reduction = reductionOf(stage.equations, id.columns, use);
  const RobustFit fit = robustFit(stage.equations, reduction, stage.rank.rank, options.outliers);
  describeModel(robot, training, options.observation, id.model);
  describeParameters(reduction, fit, id.columns, id.model);
  id.model.rank = stage.rank.rank;
  id.model.coulomb_width_m = widths;
  const Eigen::VectorXd residual =
      rmsPerActuator(equations, equations.b - equations.a * toParameters(reduction, fit.coordinates));
  id.model.residual_rms_N.assign(residual.data(), residual.data() + residual.size());

  id.rank = stage.rank;
  for (const Eigen::VectorXd& coordinates : solveEveryRank(reduction))
    id.parameters_by_rank.push_back(toParameters(reduction, coordinates));
  id.noise_N = stage.noise_N;
  id.equations = equations.rows();
  id.blocks = equations.blocks;
  id.duration_s = equations.duration_s;
  id.outlier_share = fit.outlier_share;
  id.bootstrap_block_s = fit.block_s;
  id.force_rms_N = rmsPerActuator(equations, equations.b);
  keepBlocks(stage.equations, fit.weights, id);
  return id;
}

}  // namespace knee_robot::identification
