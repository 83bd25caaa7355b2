#include <cmath>

#include "html_parts.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/recording/spectrum.h"
#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/svg_plot.h"

namespace knee_robot::report {
namespace {

constexpr double kSegment_s = 8.0;

PlotLine spectrumLine(const std::string& label, const char* color, const Eigen::VectorXd& signal, double rate_hz,
                      double highest_hz) {
  recording::Spectrum s = recording::powerSpectrum(signal, rate_hz, kSegment_s);
  while (!s.frequency_hz.empty() && s.frequency_hz.back() > highest_hz) {
    s.frequency_hz.pop_back();
    s.density.pop_back();
  }
  return {label, color, s.frequency_hz, s.density};
}

std::string maskTable(const std::vector<const identification::Observation*>& observations) {
  std::string out = "<table><tr><th>share of the samples, %</th>";
  for (const identification::Observation* o : observations)
    out += "<th>" + escapeHtml(o->name) + "</th>";
  out += "</tr>\n";
  for (std::size_t k = 0; k < observations.front()->masks.size(); ++k) {
    out += "<tr><td>" + escapeHtml(observations.front()->masks[k].reason) + "</td>";
    for (const identification::Observation* o : observations)
      out += "<td>" + htmlNumber(100.0 * o->masks[k].share) + "</td>";
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

/// The rule for the cut-off, with the spectra that it looked at.
std::string cutoffPart(const IdentifyResults& r) {
  std::string out = "<h2>Cut-off</h2>\n<p>" + escapeHtml(r.cutoff.sentence) + "</p>\n";
  if (r.cutoff.frequency_hz.empty()) return out;
  PlotLine power{"reference's acceleration, root of the power density, m/s\u00b2/root(Hz)", kMeasuredColor, {}, {}};
  PlotLine coherence{"coherence of reference and recording", kModelColor, {}, {}};
  for (std::size_t k = 1; k < r.cutoff.frequency_hz.size() && r.cutoff.frequency_hz[k] <= 12.0; ++k) {
    power.x.push_back(r.cutoff.frequency_hz[k]);
    power.y.push_back(std::sqrt(r.cutoff.reference_power[k]));
    coherence.x.push_back(r.cutoff.frequency_hz[k]);
    coherence.y.push_back(r.cutoff.coherence[k]);
  }
  PlotStyle style;
  style.x_label = "frequency, Hz";
  style.height = 200.0;
  style.markers = {r.cutoff.cutoff_hz};
  style.y_label = "m/s\u00b2/root(Hz)";
  style.log_y = true;
  out += svgPlot({power}, style);
  style.log_y = false;
  style.height = 160.0;
  style.y_label = "coherence";
  return out + svgPlot({coherence}, style);
}

}  // namespace

std::string identifySpectra(const IdentifyResults& r) {
  const bool validated = !r.validate.empty();
  const identification::Observation& o = validated ? r.validate.front() : r.train.front();
  const identification::Prediction& p = (validated ? r.validate_after : r.train_after).predictions.front();
  const double rate_hz = 1.0 / o.signals.period_s;
  const double highest_hz = 8.0 * r.options.observation.cutoff_hz;
  std::string out = "<h2>Spectrum of the residual: " + escapeHtml(o.name) +
                    "</h2>\n<p class=\"key\">Amplitude density, all " +
                    std::string(
                        "samples, nothing low-passed at the cut-off (dashed). Beyond it the command's own control "
                        "loop and noise are left, which no motion explains.</p>\n");
  PlotStyle style;
  style.x_label = "frequency, Hz";
  style.y_label = "N / root(Hz)";
  style.height = 200.0;
  style.log_y = true;
  style.markers = {r.options.observation.cutoff_hz};
  for (int i = 0; i < o.axes(); ++i) {
    const Eigen::VectorXd force = o.signals.force_N.col(i);
    out += "<h3>Actuator " + std::to_string(i + 1) + "</h3>\n" +
           svgPlot({spectrumLine("measured force", kMeasuredColor, force, rate_hz, highest_hz),
                    spectrumLine("residual", kModelColor, force - p.force_N.col(i), rate_hz, highest_hz)},
                   style);
  }
  return out;
}

std::string identifySignals(const IdentifyResults& r) {
  std::vector<const identification::Observation*> all;
  for (const auto* group : {&r.train, &r.validate}) {
    for (const identification::Observation& o : *group)
      all.push_back(&o);
  }
  std::string out =
      "<h2>What was left out</h2>\n" + maskTable(all) + cutoffPart(r) + "<h2>What was done with the signals</h2>\n";
  for (const identification::Observation* o : all) {
    out += "<h3>" + escapeHtml(o->path) + "</h3>\n<ul>\n";
    for (const std::string& note : o->notes)
      out += "<li>" + escapeHtml(note) + "</li>\n";
    out += "</ul>\n";
  }
  const identification::ObservationOptions& options = r.options.observation;
  out += "<ul><li>Positions: zero-phase low-pass at " +
         (options.motion_cutoff_given ? htmlNumber(options.signals.motion_cutoff_hz) + " Hz"
                                      : std::string("three to five times the cut-off, as the encoders allow")) +
         ", then five-point differences. Both sides of the equation: zero-phase low-pass (4th-order Butterworth, "
         "forward and "
         "backward) at " +
         htmlNumber(options.cutoff_hz) + " Hz.</li>\n<li>Fitted: " + std::to_string(r.after.equations) +
         " equations from " + htmlNumber(r.after.duration_s) +
         " s of motion, weighted with the residual of each actuator (" + std::to_string(r.after.model.axes) +
         " noise levels); " + htmlNumber(100.0 * r.after.outlier_share) +
         " % of them are outliers that count less than half; rule: " + outlierText(r.options.outliers) +
         ".</li>\n<li>Coulomb friction keeps its last value at rest and builds up over the stated displacement, so "
         "stops need no "
         "sign of the velocity.</li></ul>\n";
  return out + singleRecordingNote(r.train.size());
}

}  // namespace knee_robot::report
