#include <cstdio>

#include "compare_panels.h"
#include "knee_robot/base/constants.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/report/json_parts.h"
#include "knee_robot/report/page.h"

namespace knee_robot::report {
namespace {

const char* const kCoordinateKeys[4] = {"x", "z", "theta", "psi"};

Json figures(const ErrorFigures& e, const std::string& unit) {
  return {{"max_" + unit, jsonNumber(e.max_abs)},
          {"time_of_max_s", jsonNumber(e.time_of_max_s)},
          {"rms_" + unit, jsonNumber(e.rms)},
          {"mean_" + unit, jsonNumber(e.mean)},
          {"rows", e.rows}};
}

Json poseFigures(const ErrorFigures (&errors)[4]) {
  Json j;
  for (int k = 0; k < 4; ++k)
    j[kCoordinateKeys[k]] = figures(errors[k], k < 2 ? "m" : "rad");
  return j;
}

Json cameraJson(const CameraComparison& camera) {
  const tracing::CameraAlignment& a = camera.alignment;
  return {{"alignment",
           {{"delay_s", a.delay_known ? Json(a.delay_s) : Json()},
            {"correlation", jsonNumber(a.correlation)},
            {"rotation_rad", a.rotation_rad},
            {"shift_x_m", a.shift_x_m},
            {"shift_z_m", a.shift_z_m},
            {"plate_rad", a.plate_rad},
            {"rows", a.rows}}},
          {"camera_minus_encoders", poseFigures(camera.error)},
          {"camera_minus_encoders_regular", poseFigures(camera.error_regular)},
          {"rows_with_nearer_solution", camera.other_solution},
          {"camera_minus_nearest", poseFigures(camera.error_nearest)},
          {"camera_minus_reference", poseFigures(camera.reference_error)}};
}

std::string errorLine(const std::string& name, const std::string& unit, double factor, const ErrorFigures& e,
                      const std::string& paper) {
  char line[160];
  if (e.rows == 0) {
    std::snprintf(line, sizeof line, "%-8s %-4s %9s %9s   %s\n", name.c_str(), unit.c_str(), "-", "-", paper.c_str());
    return line;
  }
  std::snprintf(line, sizeof line, "%-8s %-4s %9.3f %9.3f   %s\n", name.c_str(), unit.c_str(), factor * e.max_abs,
                factor * e.rms, paper.c_str());
  return line;
}

}  // namespace

std::string compareJson(const CompareResults& r) {
  Json j;
  j["command"] = "compare";
  j["robot"] = r.robot_path;
  j["recording"] = {{"path", r.recording.path},
                    {"name", r.recording.name},
                    {"fingerprint", r.recording.fingerprint},
                    {"rows", r.recording.rows()},
                    {"duration_s", r.recording.time_s.back() - r.recording.time_s.front()}};
  j["actuators"] = Json::array();
  for (const ErrorFigures& e : r.actuators)
    j["actuators"].push_back(figures(e, "m"));
  j["pose"] = r.has_pose ? poseFigures(r.pose) : Json();
  if (r.has_pose) {
    j["condition_max"] = r.condition_max;
    j["rows_near_singularity"] = (r.measured.condition.array() >= r.condition_max).count();
    j["rows_without_pose"] = {{"measured", r.measured.unknown}, {"reference", r.reference.unknown}};
  }
  j["camera"] = r.has_camera ? cameraJson(r.camera) : Json();
  j["paper"] = Json::array();
  for (const PaperFigure& p : kPaperFigures)
    j["paper"].push_back({{"quantity", p.quantity}, {"unit", p.unit}, {"largest_error", p.paper}});
  j["notes"] = r.notes;
  j["reproduce"] = r.command_line;
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string compareSummary(const CompareResults& r) {
  std::string out = "measured minus reference   largest       rms   paper, largest\n";
  for (std::size_t i = 0; i < r.actuators.size(); ++i) {
    out += "  " + errorLine((r.has_pose ? "leg " : "axis ") + std::to_string(i + 1), "mm", 1e3, r.actuators[i],
                            r.has_pose ? kPaperFigures[i].paper : "");
  }
  for (int k = 0; r.has_pose && k < 4; ++k)
    out += "  " + errorLine(kPaperFigures[4 + k].quantity, kPaperFigures[4 + k].unit, unitOf(k), r.pose[k],
                            kPaperFigures[4 + k].paper);
  if (r.has_camera) {
    const tracing::CameraAlignment& a = r.camera.alignment;
    out += "camera minus encoders, away from singularities (delay " +
           (a.delay_known ? shortNumber(1e3 * a.delay_s, 3) + " ms" : std::string("not determined")) +
           ", frame turned " + shortNumber(kDegrees * a.rotation_rad, 3) + " deg, shifted " +
           shortNumber(1e3 * a.shift_x_m, 3) + " and " + shortNumber(1e3 * a.shift_z_m, 3) + " mm, markers turned " +
           shortNumber(kDegrees * a.plate_rad, 3) + " deg)\n";
    for (int k = 0; k < 4; ++k) {
      out += "  " + errorLine(kPaperFigures[4 + k].quantity, kPaperFigures[4 + k].unit, unitOf(k),
                              r.camera.error_regular[k], "");
    }
    out += "camera minus encoders, all rows\n";
    for (int k = 0; k < 4; ++k)
      out +=
          "  " + errorLine(kPaperFigures[4 + k].quantity, kPaperFigures[4 + k].unit, unitOf(k), r.camera.error[k], "");
  }
  for (const std::string& note : r.notes)
    out += note + "\n";
  return out;
}

void writeCompareFiles(const CompareResults& r, const std::string& folder) {
  const Page page("compare");
  makeFolder(folder);
  FileSet files;
  const std::string name = r.recording.name;
  files.add(folder + "/actuators.svg",
            panelsSvg(name + ": actuators, reference and measured (as the paper's Fig. 15)", actuatorPanels(r)));
  if (r.has_pose) {
    files.add(folder + "/pose.svg", panelsSvg(name + ": pose of the reference, of the encoders" +
                                                  (r.has_camera ? ", of the camera" : "") + " (as the paper's Fig. 16)",
                                              posePanels(r)));
  }
  addReport(files, folder, page, compareJson(r), compareSeries(r));
  files.commit();
}

}  // namespace knee_robot::report
