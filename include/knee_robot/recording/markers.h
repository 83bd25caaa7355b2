#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "knee_robot/recording/text_table.h"

namespace knee_robot::recording {

/// One marker of a motion-capture export.
struct Marker {
  std::array<std::string, 3> columns;                    ///< names (or numbers from 1) of its x, y, z
  Eigen::Vector3d platform_m = Eigen::Vector3d::Zero();  ///< where it sits on the platform, platform frame
};

/// How a motion-capture export becomes poses.
struct MarkerMap {
  TableFormat format;
  std::string time_column;   ///< empty: rows are 1 / rate_hz apart
  double time_factor = 1.0;  ///< s per unit of that column
  double rate_hz = 0.0;
  double metres = 1.0;          ///< per unit of the coordinates
  bool zero_is_missing = true;  ///< a marker at exactly 0, 0, 0 was not seen
  double tolerance_m = 0.005;   ///< a marker further than this from where the others put it is swapped or wrong
  std::vector<Marker> markers;
};

/// Reads a map file (YAML, strict):
///
///     time: {from: "Time", unit: s}          # or rate_hz: 120
///     unit: mm                               # of the coordinates: m, cm, mm
///     markers:                               # at least three that are not in one line
///       - {columns: [M1X, M1Y, M1Z], platform_m: [-0.30, 0.00, 0.02]}
///     separator: tab                         # and decimal, header, skip_lines as in a column map
///     zero_is_missing: true
///     tolerance_mm: 5
MarkerMap loadMarkerMap(const std::string& path);
/// The same from memory; `path` stands for the file in messages.
MarkerMap parseMarkerMap(const std::string& text, const std::string& path);

/// The platform in the capture's own frame, one entry per row of the export.
struct MarkerPoses {
  std::vector<double> time_s;  ///< as exported, not yet the recording's time
  std::vector<char> known;
  std::vector<Eigen::Isometry3d> pose;  ///< platform frame to capture frame; meaningful where known
  double rms_m = 0.0;                   ///< of the markers that were used, over all known rows
  int gaps = 0;                         ///< rows with fewer than three markers
  int swapped = 0;                      ///< rows in which markers had exchanged their names
  int dropped = 0;                      ///< rows in which one marker was left out because the others agree without it
  int refused = 0;                      ///< rows in which the markers are not the platform's
  std::vector<std::string> notes;
};

/// Rigid fit (Kabsch, Umeyama 1991) row by row. Markers beyond the tolerance: exchanged names are tried (of several
/// that fit, the one nearest to the pose before), then leaving one out; what does not fit then is a gap. Refusal when
/// fewer than 20 rows have a pose.
MarkerPoses fitMarkers(const TextTable& table, const MarkerMap& map);

/// The text of a recording with the columns mocap_x_m, mocap_z_m, mocap_theta_rad, mocap_psi_rad added (one row of
/// `camera` per row of the recording, nan where there is no picture). InputError when it has such columns already.
std::string withCameraColumns(const std::string& csv, const std::string& path, const Eigen::MatrixXd& camera);

}  // namespace knee_robot::recording
