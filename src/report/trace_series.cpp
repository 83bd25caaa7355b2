#include "trace_series.h"

#include <algorithm>

#include "force_series.h"
#include "knee_robot/base/constants.h"
#include "knee_robot/report/plot_series.h"

namespace knee_robot::report {
namespace {

/// Means of `before` and `after` in equal bins of x, the ends at the 1 % quantiles; nothing where a bin is nearly
/// empty.
Json binned(const Eigen::VectorXd& x, const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  constexpr int kBins = 60;
  std::vector<double> sorted(x.data(), x.data() + x.size());
  std::sort(sorted.begin(), sorted.end());
  const double low = sorted[sorted.size() / 100], high = sorted[sorted.size() - 1 - sorted.size() / 100];
  std::vector<double> middle, mean_before, mean_after;
  if (high > low) {
    Eigen::ArrayXXd sum = Eigen::ArrayXXd::Zero(kBins, 3);
    for (Eigen::Index n = 0; n < x.size(); ++n) {
      if (x[n] < low || x[n] > high) continue;
      const auto bin =
          std::min<Eigen::Index>(kBins - 1, static_cast<Eigen::Index>(kBins * (x[n] - low) / (high - low)));
      sum.row(bin) += Eigen::Array3d(1.0, before[n], after[n]).transpose();
    }
    for (int b = 0; b < kBins; ++b) {
      const bool filled = sum(b, 0) > 4.0;
      middle.push_back(low + (b + 0.5) * (high - low) / kBins);
      mean_before.push_back(filled ? sum(b, 1) / sum(b, 0) : kNan);
      mean_after.push_back(filled ? sum(b, 2) / sum(b, 0) : kNan);
    }
  }
  return {{"at", plotNumbers(middle)}, {"before", plotNumbers(mean_before)}, {"after", plotNumbers(mean_after)}};
}

/// Mean residual over velocity and position of the validation recording.
Json mapsJson(const TraceResults& r) {
  const bool validated = !r.validate.empty();
  const identification::Observation& o = validated ? r.validate.front() : r.train.front();
  const identification::Prediction& before = (validated ? r.validate_before : r.train_before).predictions.front();
  const identification::Prediction& after = (validated ? r.validate_after : r.train_after).predictions.front();
  Json j = {{"name", o.name},
            {"kind", validated ? "validate" : "train"},
            {"over_velocity", Json::array()},
            {"over_position", Json::array()}};
  std::vector<int> judged;
  for (int n = 0; n < o.samples(); ++n) {
    if (o.isJudged(n)) judged.push_back(n);
  }
  for (int i = 0; i < o.axes() && !judged.empty(); ++i) {
    const Eigen::VectorXd b = (o.force_filtered_N.col(i) - before.force_filtered_N.col(i))(judged);
    const Eigen::VectorXd a = (o.force_filtered_N.col(i) - after.force_filtered_N.col(i))(judged);
    j["over_velocity"].push_back(binned(o.signals.velocity_m_per_s.col(i)(judged), b, a));
    j["over_position"].push_back(binned(o.signals.position_m.col(i)(judged), b, a));
  }
  return j;
}

/// Camera minus encoders (m, m, rad, rad) of every recording with a camera.
Json poseJson(const tracing::PoseTrace& pose) {
  Json list = Json::array();
  if (!pose.available) return list;
  for (const auto& [kind, recordings] :
       {std::make_pair("validate", &pose.validate), std::make_pair("train", &pose.train)}) {
    for (const tracing::PoseRecording& r : *recordings) {
      const PlotSeries series(r.time_s);
      list.push_back({{"name", r.name},
                      {"kind", kind},
                      {"time_s", series.x()},
                      {"before", series.lines(r.before_error)},
                      {"after", series.lines(r.after_error)}});
    }
  }
  return list;
}

Json nextJson(const tracing::NextExperiment& n) {
  if (!n.planned) return {};
  std::vector<double> time_s;
  for (Eigen::Index k = 0; k < n.reference.points.rows(); ++k)
    time_s.push_back(n.reference.period_s * static_cast<double>(k));
  const PlotSeries series(time_s);
  return {{"time_s", series.x()}, {"length_m", series.lines(n.reference.points)}};
}

}  // namespace

Json traceSeries(const TraceResults& r) {
  Json j = {{"recordings", Json::array()}};
  appendForceSeries("validate", r.validate, r.validate_before, r.validate_after, j["recordings"]);
  appendForceSeries("train", r.train, r.train_before, r.train_after, j["recordings"]);
  j["maps"] = mapsJson(r);
  j["pose"] = poseJson(r.pose);
  j["next_experiment"] = nextJson(r.next);
  j["friction"] = frictionSeries(r.model.friction, r.units);
  return j;
}

}  // namespace knee_robot::report
