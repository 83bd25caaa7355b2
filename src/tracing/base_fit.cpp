#include "knee_robot/tracing/base_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/trained_range.h"
#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {
namespace {

constexpr int kFewestSamples = 100;

/// Takes effects off the recorded force, and lets others multiply Coulomb friction, while it lives.
class WithoutEffects {
 public:
  WithoutEffects(std::vector<identification::Observation>& recordings, const EffectsBeside& effects, double cutoff_hz)
      : recordings_(recordings) {
    for (std::size_t r = 0; r < effects.level.size(); ++r)
      recordings[r].friction_level = effects.level[r];
    for (std::size_t r = 0; r < effects.force_N.size(); ++r) {
      recorded_.push_back(recordings[r].force_filtered_N);
      if (!effects.each_N.empty()) recordings[r].beside_N = effects.each_N[r];
      Eigen::MatrixXd low = effects.force_N[r];
      recording::ZeroPhaseLowPass(cutoff_hz, 1.0 / recordings[r].signals.period_s).applyToColumns(low);
      recordings[r].force_filtered_N -= low;
    }
  }
  WithoutEffects(const WithoutEffects&) = delete;
  WithoutEffects& operator=(const WithoutEffects&) = delete;
  ~WithoutEffects() {
    for (std::size_t r = 0; r < recorded_.size(); ++r)
      recordings_[r].force_filtered_N = std::move(recorded_[r]);
    for (identification::Observation& o : recordings_) {
      o.friction_level.resize(0, 0);
      o.beside_N.clear();
    }
  }

 private:
  std::vector<identification::Observation>& recordings_;
  std::vector<Eigen::MatrixXd> recorded_;
};

BaseFit inCoordinates(const identification::Identification& id, const Stack& stack) {
  BaseFit base;
  base.columns = id.columns;
  base.friction_laws = id.model.friction;
  base.choices = id.friction;
  base.decided = id.prior.rank;
  base.start = id.reduction.start;
  base.bounded = id.reduction.minimalRank();
  const Eigen::Index coordinates = id.reduction.maximalRank();
  base.basis.resize(static_cast<Eigen::Index>(base.columns.size()), coordinates);
  for (Eigen::Index k = 0; k < coordinates; ++k)
    base.basis.col(k) = identification::toParameters(id.reduction, Eigen::VectorXd::Unit(coordinates, k)) - base.start;
  // The strength was chosen for as many equations as identification has.
  const double rows = static_cast<double>(stack.size() * stack.axes) / std::max(1, id.equations);
  base.pull = Eigen::VectorXd::Constant(coordinates, std::sqrt(id.prior.strength * rows));
  base.pull.head(base.bounded).setZero();
  base.strength = id.prior.strength;
  base.parameters = id.parameters;
  return base;
}

}  // namespace

BaseFit fitBase(const mechanism::Robot& robot, std::vector<identification::Observation>& training, const Stack& stack,
                const std::vector<identification::Column>& columns, BaseOptions how) {
  if (stack.size() < kFewestSamples) {
    throw Refusal("only " + std::to_string(stack.size()) + " usable samples in the training recordings (at least " +
                  std::to_string(kFewestSamples) + " are needed): record a longer motion, away from singular poses");
  }
  identification::IdentifyOptions options;
  options.observation.cutoff_hz = stack.cutoff_hz;
  options.observation.most_rows = stack.most_rows;
  options.rank = how.rank;
  options.uncertainty = false;
  options.towards = how.given;
  options.without_peak = how.beside.without_peak;
  options.least_strength = how.least_strength;
  options.laws_of = how.laws_of;
  BaseFit base;
  Eigen::VectorXd residual(stack.size() * stack.axes);
  {
    const WithoutEffects without(training, how.beside, stack.cutoff_hz);
    base = inCoordinates(identification::identify(robot, training, options), stack);
    for (int i = 0; i < stack.axes; ++i) {
      std::vector<Eigen::MatrixXd> modelled;
      for (const identification::Observation& o : training)
        modelled.push_back(o.regressor[static_cast<std::size_t>(i)] * base.parameters);
      residual.segment(i * stack.size(), stack.size()) =
          gatherForce(stack, training, i) - gather(stack, training, std::move(modelled)).col(0);
    }
  }
  for (identification::Observation& o : training)
    identification::setFriction(o, base.columns, base.friction_laws);
  base.trained_force_N = identification::trainedRange(training);
  base.noise_N.resize(stack.axes);
  for (int i = 0; i < stack.axes; ++i) {
    base.noise_N[i] = std::max(
        1e-6, residual.segment(i * stack.size(), stack.size()).norm() / std::sqrt(static_cast<double>(stack.size())));
  }
  if (base.columns.size() != columns.size()) throw std::invalid_argument("columns of another robot");
  base.beside = std::move(how.beside);
  return base;
}

BaseFit laidUnder(BaseFit known, std::vector<identification::Observation>& training) {
  known.beside = {};
  for (identification::Observation& o : training)
    identification::setFriction(o, known.columns, known.friction_laws);
  return known;
}

BaseFit inNewtons(BaseFit base) {
  base.noise_N.setOnes();
  return base;
}

Eigen::MatrixXd baseRows(const BaseFit& base, const std::vector<identification::Observation>& recordings,
                         const Stack& stack) {
  Eigen::MatrixXd rows(stack.size() * stack.axes, base.coordinates());
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
