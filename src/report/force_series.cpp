#include "force_series.h"

#include "knee_robot/mechanism/chain.h"
#include "knee_robot/report/plot_series.h"

namespace knee_robot::report {
namespace {

constexpr double kStep_s = 1e-3, kReversal_s = 1.0;
constexpr double kAcceleration_m_per_s2 = 5e-3;

/// Stretches of time in which every axis moves.
Json movingStretches(const identification::Observation& o) {
  Json out = Json::array();
  for (int n = 0; n < o.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    if (!o.moving[i]) continue;
    const double t = o.signals.time_s[i];
    if (n == 0 || !o.moving[i - 1]) out.push_back({t, t});
    out.back()[1] = t;
  }
  return out;
}

/// The share along a motion that slows down, reverses, and speeds up again, over the time from the turn.
std::vector<double> aroundReversal(const dynamics::FrictionLaw& law, std::vector<double>& milliseconds) {
  std::vector<double> share;
  dynamics::FrictionState state;
  state.start(1.0);
  milliseconds.clear();
  double before = -0.5 * kAcceleration_m_per_s2 * kReversal_s * kReversal_s;
  for (double t = kStep_s; t <= 2.0 * kReversal_s; t += kStep_s) {
    const double to_turn = t - kReversal_s;
    const double position = -0.5 * kAcceleration_m_per_s2 * to_turn * to_turn;
    milliseconds.push_back(1e3 * to_turn);
    share.push_back(state.step(law, position - before, kStep_s));
    before = position;
  }
  return share;
}

}  // namespace

Json forceSeries(const char* kind, const identification::Observation& o, const identification::Prediction& prediction,
                 const identification::Prediction* before) {
  const PlotSeries series(o.signals.time_s);
  Json j = {{"name", o.name},
            {"kind", kind},
            {"time_s", series.x()},
            {"moving", movingStretches(o)},
            {"measured", series.lines(o.force_filtered_N)},
            {"predicted", series.lines(prediction.force_filtered_N)},
            {"residual", series.lines(o.force_filtered_N - prediction.force_filtered_N)}};
  if (before != nullptr) j["residual_before"] = series.lines(o.force_filtered_N - before->force_filtered_N);
  return j;
}

void appendForceSeries(const char* kind, const std::vector<identification::Observation>& observations,
                       const identification::Applied& before, const identification::Applied& after, Json& list) {
  for (std::size_t k = 0; k < observations.size(); ++k)
    list.push_back(forceSeries(kind, observations[k], after.predictions[k], &before.predictions[k]));
}

Json frictionSeries(const std::vector<dynamics::FrictionLaw>& laws, const RecordedUnits& units) {
  Json shares = Json::array();
  std::vector<double> milliseconds;
  for (const dynamics::FrictionLaw& law : laws) {
    const std::vector<double> share = aroundReversal(law, milliseconds);
    const PlotSeries series(milliseconds);
    shares.push_back(
        series.line(Eigen::Map<const Eigen::VectorXd>(share.data(), static_cast<Eigen::Index>(share.size()))));
  }
  const bool turns = units.allRevolute();
  return {{"acceleration", turns ? kAcceleration_m_per_s2 / mechanism::kJointRadius_m : kAcceleration_m_per_s2},
          {"time_ms", milliseconds.empty() ? Json::array() : PlotSeries(milliseconds).x()},
          {"share_of_coulomb", shares}};
}

}  // namespace knee_robot::report
