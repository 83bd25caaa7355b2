#include "knee_robot/recording/markers.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/strict_yaml.h"

namespace knee_robot::recording {
namespace {

constexpr int kFewestFrames = 20;
constexpr std::size_t kMostPermuted = 6;

double metresPer(const std::string& unit) {
  return unit == "m" ? 1.0 : unit == "cm" ? 1e-2 : 1e-3;
}

/// Points as columns.
using Cloud = Eigen::Matrix3Xd;

struct Fit {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double worst_m = std::numeric_limits<double>::infinity();
  double squares = 0.0;
};

Fit fit(const Cloud& layout, const Cloud& seen) {
  Fit f;
  f.pose.matrix() = Eigen::umeyama(layout, seen, false);
  const Cloud left = seen - f.pose * layout;
  f.squares = left.squaredNorm();
  f.worst_m = left.colwise().norm().maxCoeff();
  return f;
}

bool inOneLine(const Cloud& points) {
  const Cloud centered = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d scatter = centered * centered.transpose();
  const Eigen::Vector3d squares =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter, Eigen::EigenvaluesOnly).eigenvalues();
  return points.cols() < 3 || squares[1] < 1e-6 * squares[2] || squares[1] < 1e-6;
}

double change(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm() +
         0.3 * Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

Cloud reordered(const Cloud& points, const std::vector<int>& order) {
  Cloud out(3, points.cols());
  for (std::size_t k = 0; k < order.size(); ++k)
    out.col(static_cast<Eigen::Index>(k)) = points.col(order[k]);
  return out;
}

/// Exchanged names: the fitting order nearest to the pose before; infinite when none fits.
Fit fitExchanged(const Cloud& layout, const Cloud& seen, double tolerance_m, const Eigen::Isometry3d* before) {
  std::vector<int> order(static_cast<std::size_t>(seen.cols()));
  std::iota(order.begin(), order.end(), 0);
  Fit best;
  double best_change = std::numeric_limits<double>::infinity();
  while (order.size() <= kMostPermuted && std::next_permutation(order.begin(), order.end())) {
    const Fit f = fit(layout, reordered(seen, order));
    if (f.worst_m > tolerance_m) continue;
    const double moved = before ? change(*before, f.pose) : f.worst_m;
    if (moved >= best_change) continue;
    best_change = moved;
    best = f;
  }
  return best;
}

/// Without the one marker that the others disagree with; infinite when that does not help.
Fit fitWithoutOne(const Cloud& layout, const Cloud& seen, double tolerance_m) {
  Fit best;
  for (Eigen::Index skipped = 0; seen.cols() > 3 && skipped < seen.cols(); ++skipped) {
    Cloud fewer_layout(3, seen.cols() - 1), fewer(3, seen.cols() - 1);
    fewer_layout << layout.leftCols(skipped), layout.rightCols(seen.cols() - skipped - 1);
    fewer << seen.leftCols(skipped), seen.rightCols(seen.cols() - skipped - 1);
    if (inOneLine(fewer_layout)) continue;
    const Fit f = fit(fewer_layout, fewer);
    if (f.worst_m <= tolerance_m && f.worst_m < best.worst_m) best = f;
  }
  return best;
}

/// Names that could be exchanged without anybody noticing.
bool hidesExchanges(const Cloud& layout, double tolerance_m) {
  return layout.cols() <= static_cast<Eigen::Index>(kMostPermuted) &&
         std::isfinite(fitExchanged(layout, layout, tolerance_m, nullptr).worst_m);
}

std::vector<double> timesOf(const TextTable& table, const MarkerMap& map) {
  std::vector<double> time;
  if (map.time_column.empty()) {
    for (int i = 0; i < table.rows(); ++i)
      time.push_back(i / map.rate_hz);
    return time;
  }
  const int column = table.find(map.time_column);
  time = table.numbers(column);
  for (std::size_t i = 0; i < time.size(); ++i) {
    time[i] *= map.time_factor;
    if (i > 0 && !(time[i] > time[i - 1]))
      table.refuse(static_cast<int>(i), column, "time does not increase from the row before");
  }
  return time;
}

std::string share(int count, std::size_t of) {
  return std::to_string(count) + " (" + shortNumber(100.0 * count / static_cast<double>(of), 2) + " %)";
}

/// The pose of one row with swapped names put right, or without one wrong marker, counted in `out`; worst_m is infinite
/// when neither helps.
Fit fitRow(const Cloud& at, const Cloud& points, double tolerance_m, const Eigen::Isometry3d* before,
           MarkerPoses& out) {
  Fit f = fit(at, points);
  if (f.worst_m <= tolerance_m) return f;
  int* counter = &out.swapped;
  f = fitExchanged(at, points, tolerance_m, before);
  if (!std::isfinite(f.worst_m)) {
    counter = &out.dropped;
    f = fitWithoutOne(at, points, tolerance_m);
  }
  if (!std::isfinite(f.worst_m)) counter = &out.refused;
  ++*counter;
  return f;
}

}  // namespace

MarkerMap parseMarkerMap(const std::string& text, const std::string& path) {
  StrictMap file = StrictMap::parse(text, path);
  MarkerMap map;
  map.format = readTableFormat(file);
  map.zero_is_missing = file.flagOr("zero_is_missing", true);
  map.tolerance_m = 1e-3 * file.numberOr("tolerance_mm", 5.0, 0.01, 1000.0);
  map.metres = metresPer(file.choice("unit", {"m", "cm", "mm"}));
  if (std::optional<StrictMap> time = file.mapIfAny("time")) {
    map.time_column = time->text("from");
    const std::string unit = time->choice("unit", {"s", "ms", "us"});
    map.time_factor = unit == "s" ? 1.0 : unit == "ms" ? 1e-3 : 1e-6;
    time->finish();
  } else {
    map.rate_hz = file.number("rate_hz", 0.1, 1e5);
  }
  Cloud layout(3, 0);
  for (StrictMap& entry : file.maps("markers")) {
    Marker m;
    const std::vector<std::string> columns = entry.texts("columns");
    if (columns.size() != 3) entry.refuse("columns", "a marker has three columns: x, y, z");
    std::copy(columns.begin(), columns.end(), m.columns.begin());
    const std::vector<double> at = entry.numbers("platform_m", 3, -10.0, 10.0);
    m.platform_m = Eigen::Vector3d(at[0], at[1], at[2]);
    entry.finish();
    map.markers.push_back(m);
    layout.conservativeResize(3, layout.cols() + 1);
    layout.col(layout.cols() - 1) = m.platform_m;
  }
  file.finish();
  if (inOneLine(layout)) throw InputError(path + ": needs at least three markers that do not lie in one line");
  return map;
}

MarkerMap loadMarkerMap(const std::string& path) {
  return parseMarkerMap(readFile(path, 1u << 20), path);
}

MarkerPoses fitMarkers(const TextTable& table, const MarkerMap& map) {
  const auto count = static_cast<Eigen::Index>(map.markers.size());
  Cloud layout(3, count);
  std::vector<std::vector<double>> values;
  for (Eigen::Index m = 0; m < count; ++m) {
    const Marker& marker = map.markers[static_cast<std::size_t>(m)];
    layout.col(m) = marker.platform_m;
    for (const std::string& column : marker.columns)
      values.push_back(table.numbers(table.find(column), true));
  }
  MarkerPoses out;
  out.notes = table.notes();
  out.time_s = timesOf(table, map);
  if (hidesExchanges(layout, map.tolerance_m))
    out.notes.push_back("The markers' layout looks the same with some names exchanged: such swaps cannot be noticed.");
  double squares = 0.0;
  long used = 0;
  const Eigen::Isometry3d* before = nullptr;
  out.pose.reserve(out.time_s.size());
  for (std::size_t row = 0; row < out.time_s.size(); ++row) {
    Cloud seen(3, count), there(3, count);
    Eigen::Index visible = 0;
    for (Eigen::Index m = 0; m < count; ++m) {
      const std::size_t at = 3 * static_cast<std::size_t>(m);
      const Eigen::Vector3d p(values[at][row], values[at + 1][row], values[at + 2][row]);
      if (!p.allFinite() || (map.zero_is_missing && p.isZero(0.0))) continue;
      seen.col(visible) = map.metres * p;
      there.col(visible++) = layout.col(m);
    }
    out.known.push_back(0);
    out.pose.push_back(Eigen::Isometry3d::Identity());
    const Cloud points = seen.leftCols(visible), at = there.leftCols(visible);
    if (visible < 3 || inOneLine(at)) {
      ++out.gaps;
      continue;
    }
    const Fit f = fitRow(at, points, map.tolerance_m, before, out);
    if (!std::isfinite(f.worst_m)) continue;
    out.known.back() = 1;
    out.pose.back() = f.pose;
    before = &out.pose.back();  // stays there: the vector is reserved
    squares += f.squares;
    used += visible;
  }
  const auto known = std::count(out.known.begin(), out.known.end(), 1);
  if (known < kFewestFrames) {
    throw Refusal(table.path() + ": only " + std::to_string(known) + " rows have a pose (" + std::to_string(out.gaps) +
                  " with fewer than three markers, " + std::to_string(out.refused) +
                  " in which the markers are not where the map puts them on the platform); check units and layout");
  }
  out.rms_m = std::sqrt(squares / static_cast<double>(used));
  const std::size_t rows = out.time_s.size();
  out.notes.push_back(
      "Of " + std::to_string(rows) + " rows " + share(out.gaps, rows) + " have fewer than three markers, " +
      share(out.swapped, rows) + " have exchanged names (put right), " + share(out.dropped, rows) +
      " one wrong marker (left out), " + share(out.refused, rows) + " do not fit (left out); markers are " +
      shortNumber(1e3 * out.rms_m, 3) + " mm rms from the rigid platform.");
  return out;
}

std::string withCameraColumns(const std::string& csv, const std::string& path, const Eigen::MatrixXd& camera) {
  std::string out;
  std::size_t at = 0;
  for (Eigen::Index row = -1; row < camera.rows(); ++row) {
    const std::size_t end = std::min(csv.find('\n', at), csv.size());
    std::string line = csv.substr(at, end - at);
    at = std::min(end + 1, csv.size());
    while (!line.empty() && (line.back() == '\r' || line.back() == ' '))
      line.pop_back();
    if (row < 0) {
      if (line.find("mocap_") != std::string::npos)
        throw InputError(path + ":1: has camera columns already; give the recording without them");
      out += line + ",mocap_x_m,mocap_z_m,mocap_theta_rad,mocap_psi_rad\n";
      continue;
    }
    out += line;
    for (int k = 0; k < 4; ++k)
      out += "," + (std::isfinite(camera(row, k)) ? shortNumber(camera(row, k), 9) : std::string("nan"));
    out += "\n";
  }
  return out;
}

}  // namespace knee_robot::recording
