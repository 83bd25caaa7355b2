#include "knee_robot/tracing/next_experiment.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/parallel.h"
#include "knee_robot/excitation/fourier_series.h"
#include "knee_robot/trajectory/pose_limits.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLeastAngle_rad = 0.0175;  ///< below a degree two explanations are one
constexpr double kBetter = 1.1;
constexpr double kVisible = 2.0;  ///< times the floor that an effect must leave to count in full

Eigen::MatrixXd basisOf(const Eigen::MatrixXd& columns) {
  const Eigen::VectorXd norms = columns.colwise().norm().cwiseMax(1e-300).transpose();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns.rows(), columns.cols());
  qr.setThreshold(1e-9);
  qr.compute(columns * norms.cwiseInverse().asDiagonal());
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
}

/// A group made orthogonal to q; empty columns when hardly anything is left of it.
Eigen::MatrixXd orthogonalTo(const Eigen::MatrixXd& q, const Eigen::MatrixXd& columns) {
  constexpr double kAbsorbed = 1e-3;
  const Eigen::MatrixXd left = columns - q * (q.transpose() * columns);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index c = 0; c < left.cols(); ++c) {
    if (left.col(c).norm() > kAbsorbed * columns.col(c).norm()) kept.push_back(c);
  }
  Eigen::MatrixXd out(left.rows(), static_cast<Eigen::Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k)
    out.col(static_cast<Eigen::Index>(k)) = left.col(kept[k]);
  return out;
}

/// Rows of the finished model along recordings: what hypotheses look at.
TraceData rowsAlong(const mechanism::Robot& robot, const TraceResult& result,
                    std::vector<identification::Observation> recordings,
                    const identification::ObservationOptions& options) {
  TraceData data;
  data.recordings = std::move(recordings);
  for (identification::Observation& o : data.recordings)
    setFriction(o, result.base.columns, result.base.friction_laws);
  data.stack = makeStack(data.recordings, options);
  const BaseFit newtons = inNewtons(result.base);
  data.all_base_rows = baseRows(newtons, data.recordings, data.stack);
  data.all_force_rows = Eigen::VectorXd::Zero(data.all_base_rows.rows());
  setAttention(data, Attention::All);
  const int count = static_cast<int>(data.recordings.size());
  for (int r = 0; r < count; ++r) {
    data.inputs.push_back(
        effectInput(robot, data.recordings[static_cast<std::size_t>(r)], result.base.friction_laws, r, count));
    setModel(data.inputs.back(), result.base.columns, result.parameters);
  }
  return data;
}

double cosineOf(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::MatrixXd product = basisOf(a).transpose() * basisOf(b);
  return std::min(1.0, Eigen::JacobiSVD<Eigen::MatrixXd>(product).singularValues()[0]);
}

std::string whereText(const Candidate& candidate, int actuator) {
  return candidate.name() + (actuator < 0 ? "" : " on actuator " + std::to_string(actuator + 1));
}

/// The pair to be separated.
struct Rivals {
  const FoundEffect* first = nullptr;
  const Candidate* second = nullptr;
};

Rivals confusablePair(const TraceResult& result) {
  for (const FoundEffect& e : result.effects) {
    for (const std::string& name : e.indistinguishable_from) {
      for (const auto& candidate : *result.candidates) {
        if (candidate->name() == name && !candidate->isMap()) return {&e, candidate.get()};
      }
    }
  }
  return {};
}

/// Random motions of one robot, scaled to its limits.
class MotionDice {
 public:
  MotionDice(const mechanism::Robot& robot, double duration_s, std::uint64_t seed) : robot_(robot), random_(seed) {
    duration_s_ = duration_s;
    if (robot.mechanism) {
      robot_.singularity_condition_max = trajectory::planningCondition(robot);
      findCentre();
    }
    for (int i = 0; !robot.mechanism && i < robot.axes(); ++i) {
      const mechanism::Actuator& a = robot.actuators[static_cast<std::size_t>(i)];
      centre_[i] = 0.5 * (a.position_min_m + a.position_max_m);
    }
  }

  excitation::FourierSeries any() {
    excitation::FourierSeries s;
    s.space = robot_.mechanism ? trajectory::Space::Platform : trajectory::Space::Actuator;
    s.shape.harmonics = 1 + static_cast<int>(random_() % 5);
    s.shape.ramp_s = 2.0;
    s.shape.duration_s = duration_s_;
    s.shape.period_s = std::exp(std::log(3.0) + uniform() * std::log(duration_s_ / 3.0));
    s.centre = centre_;
    s.coefficients = Eigen::MatrixXd::Zero(4, excitation::coefficientColumns(s.shape));
    for (int i = 0; i < moved(); ++i) {
      const double size = uniform();
      for (Eigen::Index c = 0; c < s.coefficients.cols(); ++c)
        s.coefficients(i, c) = size * unit(i) * normal() / (1.0 + static_cast<double>(c / 2));
    }
    return s;
  }

  excitation::FourierSeries near(excitation::FourierSeries s, double step) {
    for (int i = 0; i < moved(); ++i) {
      for (Eigen::Index c = 0; c < s.coefficients.cols(); ++c)
        s.coefficients(i, c) += step * unit(i) * normal();
    }
    s.shape.period_s = std::clamp(s.shape.period_s * std::exp(0.5 * step * normal()), 2.0, duration_s_);
    return s;
  }

  /// The largest amplitude, up to twice the drawn one, that the limits allow; nothing when hardly any.
  std::optional<excitation::FourierSeries> fitted(const excitation::FourierSeries& s) const {
    double fits = 0.0, beyond = 2.0;
    for (int round = 0; round < 7; ++round) {
      const double middle = 0.5 * (fits + beyond);
      (trajectory::checkReference(excitation::sampledReference(scaled(s, middle)), robot_).ok() ? fits : beyond) =
          middle;
    }
    if (fits < 0.02) return std::nullopt;
    return scaled(s, fits);
  }

  /// In actuator lengths, checked.
  trajectory::Reference reference(const excitation::FourierSeries& s, trajectory::ReferenceCheck& check) const {
    trajectory::Reference r = excitation::sampledReference(s);
    check = trajectory::checkReference(r, robot_);
    r.space = trajectory::Space::Actuator;
    r.points = check.lengths;
    r.name = "next_experiment.txt";
    check = trajectory::checkReference(r, robot_);
    return r;
  }

 private:
  int moved() const { return robot_.mechanism ? 4 : robot_.axes(); }
  double uniform() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  double normal() { return std::normal_distribution<double>(0.0, 1.0)(random_); }
  double unit(int i) const { return robot_.mechanism ? (i < 2 ? 0.1 : 0.2) : 0.1; }

  static excitation::FourierSeries scaled(excitation::FourierSeries s, double factor) {
    s.coefficients *= factor;
    return s;
  }

  /// Level pose that keeps furthest from all limits.
  void findCentre() {
    double best = -1e9;
    for (double x = -0.2; x < 0.21; x += 0.05) {
      for (double z = 0.3; z < 1.2; z += 0.025) {
        const mechanism::Pose pose(x, z, 0.0, 0.0);
        const double left = trajectory::nearestLimit(robot_, pose, robot_.singularity_condition_max).left;
        if (left <= best) continue;
        best = left;
        centre_ = pose;
      }
    }
  }

  mechanism::Robot robot_;
  std::mt19937_64 random_;
  double duration_s_ = 30.0;
  mechanism::Vector4 centre_ = mechanism::Vector4::Zero();
};

/// A motion that was looked at.
struct Motion {
  std::optional<excitation::FourierSeries> series;  ///< none: hardly any amplitude is within the limits
  trajectory::Reference reference;
  trajectory::ReferenceCheck check;
  Separation separation;
  double score = 0.0;
};

double scoreOf(const Separation& s, double floor_N) {
  return s.angle_rad * std::min(1.0, s.visible_N / std::max(1e-9, kVisible * floor_N));
}

}  // namespace

recording::Recording idealRecording(const trajectory::Reference& reference, int axes) {
  recording::Recording r;
  r.path = r.name = reference.name;
  r.axes = axes;
  r.position_m = reference.points.leftCols(axes);
  r.force_N = Eigen::MatrixXd::Zero(reference.points.rows(), axes);
  for (Eigen::Index n = 0; n < reference.points.rows(); ++n)
    r.time_s.push_back(reference.period_s * static_cast<double>(n));
  return r;
}

Separation separationOf(const mechanism::Robot& robot, const TraceResult& result, const FoundEffect& first,
                        const Candidate& rival, std::vector<identification::Observation> recordings,
                        const identification::ObservationOptions& options) {
  const TraceData data = rowsAlong(robot, result, std::move(recordings), options);
  const Eigen::VectorXd& noise = result.after_rms_N;
  const Eigen::MatrixXd q = basisOf(weighted(data.stack, data.base_rows, noise));
  const Eigen::MatrixXd raw = weighted(data.stack, effectRows(data, first.hypothesis), noise);
  const Eigen::MatrixXd a = orthogonalTo(q, raw);
  Separation out;
  if (a.cols() == 0) return out;
  const Eigen::VectorXd effect = raw * first.coefficients, visible = effect - q * (q.transpose() * effect);
  const int actuator = first.hypothesis.place.actuator;
  out.angle_rad = 0.5 * kPi;
  double left = visible.norm();
  for (std::vector<double>& shape : rival.shapes(data.inputs.front(), actuator)) {
    const Hypothesis other{{&rival, rival.shared() ? -1 : actuator}, shape};
    const Eigen::MatrixXd b = orthogonalTo(q, weighted(data.stack, effectRows(data, other), noise));
    if (b.cols() == 0) continue;
    out.angle_rad = std::min(out.angle_rad, std::acos(cosineOf(a, b)));
    const Eigen::MatrixXd qb = basisOf(b);
    left = std::min(left, (visible - qb * (qb.transpose() * visible)).norm());
  }
  const double unit = actuator < 0 ? noise.mean() : noise[actuator];
  out.visible_N = unit * left / std::sqrt(static_cast<double>(data.stack.size()));
  return out;
}

namespace {

/// Why no motion is looked for; empty: one is. Names the two in `out`.
std::string whyNotLookedFor(const Rivals& pair, const mechanism::Robot& robot, NextExperiment& out) {
  if (pair.first == nullptr) return "no effect in the model has another explanation that the data cannot tell from it";
  if (robot.chain) return "motions that separate two explanations are not planned for chains";
  const Place& place = pair.first->hypothesis.place;
  out.first = whereText(*place.candidate, place.actuator);
  out.second = whereText(*pair.second, place.actuator);
  if (place.candidate->transfers() && pair.second->transfers()) return "";
  return "one of " + out.first + " and " + out.second +
         " belongs to one recording only: no planned motion brings it back";
}

/// Random motions, then variations of the best; the best is kept in `out`. True when any has a score.
template <typename Look>
bool findBest(MotionDice& dice, const NextExperimentOptions& plan, const Look& look, NextExperiment& out) {
  double best_score = 0.0;
  std::optional<excitation::FourierSeries> best;
  const auto keepIfBetter = [&](Motion m) {
    if (m.series) ++out.motions;
    if (m.score <= best_score) return false;
    best_score = m.score;
    best = m.series;
    out.then = m.separation;
    out.reference = std::move(m.reference);
    out.check = std::move(m.check);
    return true;
  };
  std::vector<excitation::FourierSeries> drawn;
  for (int k = 0; k < plan.random; ++k)
    drawn.push_back(dice.any());
  std::vector<Motion> random(drawn.size());
  inParallel(drawn.size(), [&](std::size_t k) { random[k] = look(drawn[k]); });
  for (Motion& m : random)
    keepIfBetter(std::move(m));
  double step = 0.5;
  for (int k = 0; best && k < plan.improving; ++k)
    step = keepIfBetter(look(dice.near(*best, step))) ? step * 1.2 : std::max(0.05, step * 0.93);
  return best.has_value();
}

}  // namespace

NextExperiment planNextExperiment(const mechanism::Robot& robot, const TraceResult& result,
                                  const std::vector<identification::Observation>& training, const TraceOptions& options,
                                  const NextExperimentOptions& plan) {
  NextExperiment out;
  const Rivals pair = confusablePair(result);
  out.reason = whyNotLookedFor(pair, robot, out);
  if (!out.reason.empty()) return out;
  options.progress("planning the motion that separates " + out.first + " from " + out.second);
  const identification::ObservationOptions& observing = options.observation;
  out.now = separationOf(robot, result, *pair.first, *pair.second, training, observing);
  const int actuator = pair.first->hypothesis.place.actuator;
  const double floor_N = actuator < 0 ? result.floor_N.mean() : result.floor_N[actuator];
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  MotionDice dice(robot, plan.duration_s, plan.seed);
  const auto look = [&](const excitation::FourierSeries& drawn) {
    Motion m;
    m.series = dice.fitted(drawn);
    if (!m.series) return m;
    m.reference = dice.reference(*m.series, m.check);
    if (!m.check.ok()) return m;
    std::vector<identification::Observation> along = {
        identification::observe(robot, columns, idealRecording(m.reference, robot.axes()), observing)};
    m.separation = separationOf(robot, result, *pair.first, *pair.second, std::move(along), observing);
    m.score = scoreOf(m.separation, floor_N);
    return m;
  };
  out.planned = findBest(dice, plan, look, out) && out.then.angle_rad > kLeastAngle_rad &&
                scoreOf(out.then, floor_N) > kBetter * scoreOf(out.now, floor_N);
  if (!out.planned) {
    out.reason = "none of " + std::to_string(out.motions) + " motions within the robot's limits separates " +
                 out.first + " from " + out.second + " clearly better than the training recordings do (largest angle " +
                 shortNumber(kDegrees * out.then.angle_rad, 2) + " deg, before " +
                 shortNumber(kDegrees * out.now.angle_rad, 2) + " deg)";
  }
  return out;
}

}  // namespace knee_robot::tracing
