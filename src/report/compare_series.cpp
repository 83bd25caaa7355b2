#include "compare_panels.h"
#include "knee_robot/report/plot_series.h"

namespace knee_robot::report {

Json compareSeries(const CompareResults& r) {
  const PlotSeries series(r.recording.time_s);
  Json j = {{"time_s", series.x()},
            {"reference_m", series.lines(r.recording.reference_m)},
            {"measured_m", series.lines(r.recording.position_m)},
            {"error_m", series.lines(r.recording.position_m - r.recording.reference_m)},
            {"near_singularity", Json::array()},
            {"pose", Json()}};
  if (!r.has_pose) return j;
  for (const auto& [from, to] : singularStretches(r))
    j["near_singularity"].push_back({from, to});
  j["pose"] = {{"reference", series.lines(r.reference.pose)},
               {"encoders", series.lines(r.measured.pose)},
               {"error", series.lines(r.measured.pose - r.reference.pose)}};
  if (r.has_camera) {
    j["pose"]["camera"] = series.lines(r.camera.pose);
    j["pose"]["camera_error"] = series.lines(r.camera.pose - r.measured.pose);
  }
  return j;
}

}  // namespace knee_robot::report
