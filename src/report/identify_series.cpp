#include "identify_series.h"

#include <cmath>

#include "force_series.h"
#include "knee_robot/recording/spectrum.h"
#include "knee_robot/report/plot_series.h"

namespace knee_robot::report {
namespace {

constexpr double kSegment_s = 8.0;
constexpr double kHighestReference_hz = 12.0;

/// Amplitude densities per actuator of measured force and residual, nothing low-passed at the cut-off.
Json spectraJson(const IdentifyResults& r) {
  const bool validated = !r.validate.empty();
  const identification::Observation& o = validated ? r.validate.front() : r.train.front();
  const identification::Prediction& p = (validated ? r.validate_after : r.train_after).predictions.front();
  const double highest_hz = 8.0 * r.options.observation.cutoff_hz;
  Json j = {
      {"name", o.name}, {"frequency_hz", Json::array()}, {"measured", Json::array()}, {"residual", Json::array()}};
  const auto density = [&](const Eigen::VectorXd& signal) {
    recording::Spectrum s = recording::powerSpectrum(signal, 1.0 / o.signals.period_s, kSegment_s);
    while (!s.frequency_hz.empty() && s.frequency_hz.back() > highest_hz) {
      s.frequency_hz.pop_back();
      s.density.pop_back();
    }
    j["frequency_hz"] = logNumbers(s.frequency_hz);
    return logNumbers(s.density);
  };
  for (int i = 0; i < o.axes(); ++i) {
    j["measured"].push_back(density(o.signals.force_N.col(i)));
    j["residual"].push_back(density(o.signals.force_N.col(i) - p.force_N.col(i)));
  }
  return j;
}

/// The spectra that the rule for the cut-off looked at.
Json cutoffJson(const recording::CutoffChoice& cutoff) {
  std::vector<double> frequency_hz, acceleration, coherence;
  for (std::size_t k = 1; k < cutoff.frequency_hz.size() && cutoff.frequency_hz[k] <= kHighestReference_hz; ++k) {
    frequency_hz.push_back(cutoff.frequency_hz[k]);
    acceleration.push_back(std::sqrt(cutoff.reference_power[k]));
    coherence.push_back(cutoff.coherence[k]);
  }
  return {{"chosen_hz", cutoff.cutoff_hz},
          {"frequency_hz", logNumbers(frequency_hz)},
          {"reference_acceleration", logNumbers(acceleration)},
          {"coherence", plotNumbers(coherence)}};
}

}  // namespace

Json identifySeries(const IdentifyResults& r) {
  Json j = {{"recordings", Json::array()}};
  appendForceSeries("validate", r.validate, r.validate_before, r.validate_after, j["recordings"]);
  appendForceSeries("train", r.train, r.train_before, r.train_after, j["recordings"]);
  j["spectra"] = spectraJson(r);
  j["cutoff"] = cutoffJson(r.cutoff);
  j["friction"] = frictionSeries(r.after.model.friction, r.units);
  return j;
}

}  // namespace knee_robot::report
