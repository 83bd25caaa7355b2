#include "knee_robot/identification/identify.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/prior.h"
#include "knee_robot/identification/robust_fit.h"
#include "knee_robot/identification/trained_range.h"
#include "loaded_start.h"
#include "masking.h"
#include "refusals.h"

namespace knee_robot::identification {
namespace {

constexpr double kDetermined = 0.99;  ///< share of a parameter's own direction that the kept directions must contain
constexpr double kWellKnown = 0.1;    ///< relative standard error of an identified parameter

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

constexpr int kFrictionPasses = 3;
constexpr double kOutlier = 2.0;         ///< noises
constexpr double kAskedStrength = 1e-6;  ///< when a number of directions was asked for, those are fitted freely
constexpr double kWidestNarrow_m = 1e-3;
constexpr double kFirstStrength = 1.0;  ///< of the prior, until it is chosen

/// What is fitted to equations weighted with some noise.
struct Stage {
  Equations equations;  ///< weighted with noise_N
  Eigen::VectorXd noise_N;
  Reduction reduction;
  Eigen::VectorXd parameters;
};

/// Everything that stays the same from stage to stage.
struct Setting {
  const std::vector<Column>& columns;
  const std::vector<char>& use;
  Prior prior;
  int rank = 0;  ///< that was asked for; 0: all directions

  int rankOf(const Reduction& r) const {
    return rank > 0 ? std::clamp(rank, r.minimalRank(), r.maximalRank()) : r.maximalRank();
  }
};

/// Huber's weights: one push must not decide how much the prior counts.
void softenOutliers(Equations& weighted, const Eigen::VectorXd& parameters) {
  const Eigen::VectorXd residual = weighted.b - weighted.a * parameters;
  const Eigen::ArrayXd root = (kOutlier / residual.array().abs().max(kOutlier)).sqrt();  // 1 where it is none
  weighted.a.array().colwise() *= root;
  weighted.b.array() *= root;
}

/// `soften`: parameters of the fit before, by whose residuals outliers count less; null: all rows count.
Stage solveStage(Equations equations, const Eigen::VectorXd& noise_N, const Setting& setting, double strength,
                 const Eigen::VectorXd* soften = nullptr) {
  Stage s;
  s.noise_N = noise_N;
  s.equations = std::move(equations);
  weightRows(s.equations, noise_N);
  if (soften != nullptr) softenOutliers(s.equations, *soften);
  s.reduction = reduce(joinBlocks(compressBlocks(s.equations), -1), setting.columns, setting.use, setting.prior);
  s.parameters = toParameters(s.reduction, solveWithPrior(s.reduction, setting.rankOf(s.reduction), strength));
  return s;
}

Eigen::VectorXd noiseAfter(const Equations& unweighted, const Eigen::VectorXd& parameters) {
  return noiseInMotionAndNearRest(unweighted, unweighted.b - unweighted.a * parameters);
}

std::string verdictOf(double value, double std) {
  return std < kWellKnown * std::abs(value) ? "identified" : "weakly identified";
}

/// Share of what the prior leaves open of a column that the data decide, 0 to 1.
double decidedShare(const Reduction& r, const Prior& prior, std::size_t other, int directions, double strength) {
  const double open = prior.transform.row(r.others[other]).squaredNorm();
  double decided = 0.0;
  for (int d = 0; d < directions; ++d) {
    const double part = r.directions(static_cast<Eigen::Index>(other), d);
    decided += part * part * r.information[d] / (r.information[d] + strength);
  }
  return open > 0.0 ? decided / open : 0.0;
}

/// Combinations of parameters that the data decide rather than the prior.
void describeBase(const Reduction& r, const RobustFit& fit, const Prior& prior, double strength,
                  dynamics::Model& model) {
  const int kept = r.minimalRank();
  const Eigen::MatrixXd units = prior.transform(r.others, Eigen::all);
  const Eigen::MatrixXd back = units.completeOrthogonalDecomposition().pseudoInverse();  // unit coordinates of a change
  for (int d = 0; d < static_cast<int>(fit.coordinates.size()) - kept; ++d) {
    if (r.information[d] < strength) continue;
    const Eigen::VectorXd weights = back.transpose() * (back * r.directions.col(d));
    dynamics::BaseParameter base;
    base.std = std::sqrt(std::max(0.0, fit.covariance(kept + d, kept + d)));
    base.weights.assign(model.parameters.size(), 0.0);
    base.value = fit.coordinates[kept + d];
    for (std::size_t k = 0; k < r.others.size(); ++k) {
      const double weight = weights[static_cast<Eigen::Index>(k)];
      base.weights[static_cast<std::size_t>(r.others[k])] = weight;
      base.value += weight * r.start[r.others[k]];
    }
    model.base.push_back(base);
  }
}

void describeParameters(const Reduction& r, const RobustFit& fit, const Setting& setting, double strength,
                        dynamics::Model& model) {
  const Eigen::VectorXd values = toParameters(r, fit.coordinates);
  for (std::size_t c = 0; c < setting.columns.size(); ++c) {
    dynamics::ModelParameter p;
    p.name = setting.columns[c].name;
    p.unit = setting.columns[c].unit;
    p.value = values[static_cast<Eigen::Index>(c)];
    model.parameters.push_back(p);
  }
  if (fit.covariance.size() == 0) return;
  const int kept = r.minimalRank();
  for (int i = 0; i < kept; ++i) {
    const int c = r.kept[static_cast<std::size_t>(i)];
    dynamics::ModelParameter& p = model.parameters[static_cast<std::size_t>(c)];
    p.std = std::sqrt(std::max(0.0, fit.covariance(i, i))) / r.scale[c];
    p.verdict = p.value > 0.0 ? verdictOf(p.value, p.std) : "at its bound";
  }
  const int directions = static_cast<int>(fit.coordinates.size()) - kept;
  for (std::size_t k = 0; k < r.others.size(); ++k) {
    if (directions == 0 || decidedShare(r, setting.prior, k, directions, strength) < kDetermined) continue;
    const Eigen::VectorXd row = r.directions.row(static_cast<Eigen::Index>(k)).head(directions).transpose();
    dynamics::ModelParameter& p = model.parameters[static_cast<std::size_t>(r.others[k])];
    p.std = std::sqrt(std::max(0.0, row.dot(fit.covariance.bottomRightCorner(directions, directions) * row)));
    p.verdict = verdictOf(p.value, p.std);
  }
  describeBase(r, fit, setting.prior, strength, model);
}

void describeModel(const mechanism::Robot& robot, const std::vector<Observation>& training,
                   const ObservationOptions& options, dynamics::Model& model) {
  model.kind = robot.kind;
  model.axes = robot.axes();
  model.joints = dynamics::modelJoints(robot);
  model.robot_fingerprint = robot.fingerprint;
  model.cutoff_hz = options.cutoff_hz;
  model.fit_taut_steps = options.taut_steps;
  if (options.motion_cutoff_given) model.fit_motion_cutoff_hz = options.signals.motion_cutoff_hz;
  model.moving_m_per_s = options.moving_m_per_s;
  for (const Observation& o : training)
    model.data.push_back({o.path, o.fingerprint, o.home_id});
}

/// Laws of revolute joints are described in rad.
void markRevolute(const mechanism::Robot& robot, Identification& id) {
  for (std::size_t i = 0; i < robot.actuators.size(); ++i) {
    const bool revolute = robot.actuators[i].revolute;
    id.model.friction[i].revolute = revolute;
    if (id.friction.empty()) continue;
    id.friction[i].law.revolute = revolute;
    for (TriedLaw& tried : id.friction[i].tried)
      tried.law.revolute = revolute;
  }
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

std::vector<double> narrowestWidths(const mechanism::Robot& robot, double counts) {
  std::vector<double> widths;
  for (const mechanism::Actuator& a : robot.actuators)
    widths.push_back(std::min(kWidestNarrow_m, counts * a.metresPerCount()));
  return widths;
}

namespace {

constexpr double kShareOfTravel =
    0.02;  ///< of a joint's travel: the widest displacement over which its friction builds up
constexpr double kShareOfSpeed = 0.5;  ///< of its speed: the fastest at which it is not yet full
constexpr double kSlowShare = 1e-3;

/// Of a chain, whose joints may be gears of any size, by travel and speed.
std::vector<FrictionRange> frictionRanges(const mechanism::Robot& robot, const std::vector<Observation>& training,
                                          const std::vector<double>& narrowest, const std::vector<char>& without_peak) {
  std::vector<FrictionRange> ranges;
  for (std::size_t i = 0; i < narrowest.size(); ++i) {
    FrictionRange range;
    range.narrowest_m = narrowest[i];
    range.peak = without_peak.empty() || without_peak[i] == 0;
    for (const Observation& o : training) {
      const Eigen::Index c = static_cast<Eigen::Index>(i);
      const double speed = usualSpeed(o.signals, c);
      if (!robot.chain) {
        range.growing_m_per_s = std::max(range.growing_m_per_s, speed);
        continue;
      }
      const double travel = o.signals.position_m.col(c).maxCoeff() - o.signals.position_m.col(c).minCoeff();
      range.widest_m = std::max(range.widest_m, kShareOfTravel * travel);
      range.bristles_most_m = std::max(range.bristles_most_m, 0.5 * kShareOfTravel * travel);
      range.fastest_m_per_s = std::max(range.fastest_m_per_s, kShareOfSpeed * speed);
      range.slowest_m_per_s = std::min(range.slowest_m_per_s, std::max(1e-9, kSlowShare * speed));
    }
    ranges.push_back(range);
  }
  return ranges;
}

/// The prior's strength beside the present laws; pushes count less.
PriorChoice strengthBeside(const Equations& equations, const Eigen::VectorXd& parameters, const Setting& setting,
                           double strength) {
  const Stage soft = solveStage(equations, noiseAfter(equations, parameters), setting, strength, &parameters);
  return chooseStrength(soft.equations, setting.columns, setting.use, setting.prior);
}

/// Laws near rest, the prior's strength and parameters in turn, each with what the others were: beside links that the
/// data hardly decide and nothing holds, a law is chosen that makes up for what they do.
void chooseLaws(std::vector<Observation>& training, const IdentifyOptions& options,
                const std::vector<FrictionRange>& ranges, const Setting& setting, Equations& equations, Stage& stage,
                Identification& id) {
  double strength = kFirstStrength;
  const auto useLaws = [&] {
    for (Observation& o : training)
      setFriction(o, id.columns, id.model.friction);
    refillColumns(training, options.observation, coulombColumns(id.columns), equations);
  };
  for (int pass = 0; pass < kFrictionPasses; ++pass) {
    strength = middleStrength(strengthBeside(equations, stage.parameters, setting, strength));
    stage = solveStage(equations, noiseAfter(equations, stage.parameters), setting, strength);
    findLoadedStart(id.columns, stage.parameters, options.observation.cutoff_hz, training);
    id.friction = chooseFriction(training, options.observation, id.columns, stage.equations, stage.noise_N,
                                 stage.reduction, strength, ranges, id.friction);
    for (std::size_t i = 0; i < id.friction.size(); ++i)
      id.model.friction[i] = id.friction[i].law;
    useLaws();
    stage = solveStage(equations, stage.noise_N, setting, strength);
    stage = solveStage(equations, noiseAfter(equations, stage.parameters), setting, strength);
  }
  findLoadedStart(id.columns, stage.parameters, options.observation.cutoff_hz, training);
  const std::vector<double> starts = usualStart(training);
  for (std::size_t i = 0; i < id.model.friction.size(); ++i)
    id.model.friction[i].at_start = ofThoseThatRemember(id.model.friction[i], starts[i]);
  forgetLoadedStart(training);  // parameters are fitted as recordings are predicted
  useLaws();
}

/// The prior of the robot's file, with what is not known to be positive drawn `towards` these parameters; empty: none.
Prior priorTowards(const Eigen::VectorXd& towards, const mechanism::Robot& robot, const std::vector<Column>& columns,
                   const Eigen::VectorXd& force_rms_N) {
  Prior prior = priorOf(robot, columns, force_rms_N);
  for (std::size_t c = 0; towards.size() > 0 && c < columns.size(); ++c) {
    const Eigen::Index at = static_cast<Eigen::Index>(c);
    if (!columns[c].isNonNegative()) prior.mean[at] = towards[at];
  }
  return prior;
}

}  // namespace

Identification identify(const mechanism::Robot& robot, std::vector<Observation>& training,
                        const IdentifyOptions& options) {
  Identification id;
  id.columns = columnsOf(robot, options.joint_friction);
  refuseMotionless(robot, training, options.observation);
  refuseSaturated(training);
  refuseForceless(robot, training, options.observation);
  const std::vector<char> use = usedColumns(id.columns, options.friction);
  const std::vector<double> narrowest = narrowestWidths(robot, options.narrowest_counts);
  const std::vector<FrictionRange> ranges = frictionRanges(robot, training, narrowest, options.without_peak);
  for (const double width : narrowest)
    id.model.friction.push_back(dynamics::stopLaw(width));
  const Identification* const known = options.friction ? options.laws_of.get() : nullptr;
  if (known != nullptr) {
    id.friction = known->friction;
    id.model.friction = known->model.friction;
  }
  for (Observation& o : training)
    setFriction(o, id.columns, id.model.friction);

  // First with narrow stops and weights from the forces' own size, then with what that fit says about both.
  Equations equations = stackEquations(training, options.observation);
  refuseTooShort(training, equations, options.observation);
  id.force_rms_N = rmsPerActuator(equations, equations.b);
  const Setting setting{id.columns, use, priorTowards(options.towards, robot, id.columns, id.force_rms_N),
                        options.rank};
  Stage stage;
  if (known != nullptr) {
    id.beside_laws = known->beside_laws;
  } else {
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(equations.a.cols());
    stage = solveStage(equations, noiseAfter(equations, nothing), setting, kFirstStrength);
    stage = solveStage(equations, noiseAfter(equations, stage.parameters), setting, kFirstStrength);
    if (options.friction) chooseLaws(training, options, ranges, setting, equations, stage, id);
    id.beside_laws = stage.parameters;
  }
  const Eigen::VectorXd& before = id.beside_laws;
  stage = solveStage(equations, noiseAfter(equations, before), setting, kFirstStrength, &before);
  if (options.friction) refuseRank(options.rank, stage.reduction, training);
  id.prior = chooseStrength(stage.equations, id.columns, use, setting.prior);
  const bool held = options.least_strength > id.prior.strength;
  if (held) id.prior.strength = options.least_strength;
  const double strength = options.rank > 0 ? kAskedStrength : id.prior.strength;
  stage = solveStage(equations, noiseAfter(equations, stage.parameters), setting, strength);

  id.reduction = stage.reduction;
  const int rank = setting.rankOf(id.reduction);
  const RobustFit fit = robustFit(stage.equations, id.reduction, rank, options.outliers, strength, options.uncertainty);
  id.coordinates = Eigen::VectorXd::Zero(id.reduction.maximalRank());
  id.coordinates.head(rank) = fit.coordinates;
  id.parameters = toParameters(id.reduction, fit.coordinates);
  id.prior.strength = strength;
  if (options.rank > 0) {
    id.prior.rank = rank;
  } else if (held) {
    id.prior.rank = supportedRank(id.reduction, strength);
  }
  describeModel(robot, training, options.observation, id.model);
  describeParameters(id.reduction, fit, setting, strength, id.model);
  id.model.rank = id.prior.rank;
  markRevolute(robot, id);
  const Eigen::VectorXd residual = noiseAfter(equations, id.parameters).head(equations.axes);
  id.model.residual_rms_N.assign(residual.data(), residual.data() + residual.size());

  id.model.trained_force_N = trainedRange(training);

  id.parameters_by_strength = parametersByStrength(id.reduction, id.prior);
  id.noise_N = stage.noise_N;
  id.equations = equations.rows();
  id.blocks = equations.blocks;
  id.duration_s = equations.duration_s;
  id.outlier_share = fit.outlier_share;
  id.bootstrap_block_s = fit.block_s;
  keepBlocks(stage.equations, fit.weights, id);
  return id;
}

}  // namespace knee_robot::identification
