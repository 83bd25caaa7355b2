#include "tuning_series.h"

#include <cmath>

#include "knee_robot/report/plot_series.h"

namespace knee_robot::tuning {
namespace {

constexpr double kPlotted_s = 0.5;

report::Json sensitivity(const control::PidGains& gains, const AxisPlant& plant, double period_s) {
  std::vector<double> values;
  for (const double f : marginFrequencies(period_s)) {
    const auto loop = pidResponse(gains, period_s, f) * plantResponse(plant, period_s, f);
    values.push_back(1.0 / std::abs(1.0 + loop));
  }
  return report::logNumbers(values);
}

/// Position after a step of the reference by 1, and its times.
report::Json step(const control::PidGains& gains, const AxisPlant& plant, double period_s, report::Json& time_s) {
  const std::vector<double> values = stepResponse(gains, plant, period_s, static_cast<int>(kPlotted_s / period_s));
  std::vector<double> times;
  for (std::size_t k = 0; k < values.size(); ++k)
    times.push_back(static_cast<double>(k) * period_s);
  const report::PlotSeries series(times);
  time_s = series.x();
  return series.line(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

report::Json axisSeries(const TuningResults& r, std::size_t i) {
  const TunedAxis& a = r.axes[i];
  if (!a.reason.empty()) return {};
  const auto column = static_cast<Eigen::Index>(i);
  const report::PlotSeries force(r.responses.time_s);
  report::Json j = {{"time_s", force.x()},
                    {"commanded_N", force.line(r.responses.force_N.col(column))},
                    {"model_N", force.line(r.responses.model_N.col(column))},
                    {"frequency_hz", report::logNumbers(marginFrequencies(r.servo_period_s))},
                    {"step_time_s", report::Json::array()},
                    {"loops", report::Json::array()}};
  // The worst of either end: hardly any friction, the longest delay.
  AxisPlant lightest = a.range.low, heaviest = a.range.high;
  lightest.delay_s = heaviest.delay_s;
  heaviest.viscous_N_s_per_m = lightest.viscous_N_s_per_m;
  const auto add = [&](const char* which, const control::PidGains& gains) {
    for (const auto& [end, plant] : {std::make_pair("light", &lightest), std::make_pair("heavy", &heaviest)})
      j["loops"].push_back({{"gains", which},
                            {"end", end},
                            {"sensitivity", sensitivity(gains, *plant, r.servo_period_s)},
                            {"step", step(gains, *plant, r.servo_period_s, j["step_time_s"])}});
  };
  if (a.present_worst.stable) add("present", a.present);
  if (a.proposed) add("proposed", *a.proposed);
  return j;
}

}  // namespace

report::Json tuningSeries(const TuningResults& r) {
  report::Json axes = report::Json::array();
  for (std::size_t i = 0; i < r.axes.size(); ++i)
    axes.push_back(axisSeries(r, i));
  return {{"axes", axes}};
}

}  // namespace knee_robot::tuning
