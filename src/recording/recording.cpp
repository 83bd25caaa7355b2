#include "knee_robot/recording/recording.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

#include "foreign_text.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"

namespace knee_robot::recording {
namespace {

using Text = std::string_view;

constexpr double kLargestValue = 1e6;
constexpr double kLargestTime_s = 1e11;
constexpr double kLargestHome = 9e15;  ///< a double still tells integers apart
constexpr int kMostAxes = 12;
constexpr std::size_t kMostColumns = 10000;

void splitInto(Text line, std::vector<Text>& fields) {
  fields.clear();
  while (true) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == Text::npos) return;
    line.remove_prefix(comma + 1);
  }
}

/// Where a known column's values go.
struct Column {
  std::string name;
  std::size_t field = 0;
  bool may_be_nan = false;
  std::vector<double> values;
};

/// The header: which field holds which column.
class Header {
 public:
  Header(Text line, std::string path) : path_(std::move(path)) {
    std::vector<Text> fields;
    splitInto(line, fields);
    if (fields.size() > kMostColumns) throw InputError(path_ + ":1: more than 10000 columns; this is no recording");
    count_ = fields.size();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto [place, is_new] = where_.emplace(std::string(fields[i]), i);
      if (!is_new && known(place->first)) throw InputError(path_ + ":1: column " + place->first + " occurs twice");
    }
  }

  std::size_t count() const { return count_; }
  bool has(const std::string& name) const { return where_.count(name) > 0; }

  Column need(const std::string& name, const std::string& why) const {
    const auto found = where_.find(name);
    if (found == where_.end()) throw InputError(path_ + ":1: column " + name + " is missing" + why);
    return {name, found->second, false, {}};
  }

  static std::string axisName(const char* signal, int axis, const char* unit) {
    return std::string(signal) + "_" + std::to_string(axis) + unit;
  }

 private:
  static bool known(const std::string& name) {
    static const char* const kStarts[] = {"time_s", "position_",    "reference_", "velocity_", "command_",
                                          "force_", "mocap_",       "torque_",    "current_",  "home_id",
                                          "motor_", "temperature_", "test_pulse"};
    return std::any_of(std::begin(kStarts), std::end(kStarts),
                       [&](const char* start) { return name.rfind(start, 0) == 0; });
  }

  std::string path_;
  std::size_t count_ = 0;
  std::map<std::string, std::size_t> where_;
};

/// Unit of a signal's column on one axis: the first of `units` that the file has; null when it has none of them.
const char* unitOn(const Header& header, const char* signal, int axis, const std::vector<const char*>& units) {
  for (const char* unit : units) {
    if (header.has(Header::axisName(signal, axis, unit))) return unit;
  }
  return nullptr;
}

/// All columns of one signal over the axes, each in any of `units`; none when the file has none of them. One without
/// the others is an error.
std::vector<Column> signalColumns(const Header& header, const char* signal, const std::vector<const char*>& units,
                                  int axes) {
  bool any = false;
  for (int i = 1; i <= kMostAxes; ++i)
    any = any || unitOn(header, signal, i, units) != nullptr;
  std::vector<Column> columns;
  if (!any) return columns;
  for (int i = 1; i <= axes; ++i) {
    const char* const unit = unitOn(header, signal, i, units);
    columns.push_back(header.need(Header::axisName(signal, i, unit != nullptr ? unit : units.front()),
                                  ", though other axes have it"));
  }
  return columns;
}

const std::vector<const char*> kPositionUnits = {"_m", "_rad"};

int countAxes(const Header& header) {
  int axes = 1;
  if (unitOn(header, "position", 1, kPositionUnits) == nullptr) header.need("position_1_m", "");
  for (int i = 2; i <= kMostAxes; ++i) {
    if (unitOn(header, "position", i, kPositionUnits) != nullptr) axes = i;
  }
  for (int i = 2; i <= axes; ++i) {
    if (unitOn(header, "position", i, kPositionUnits) == nullptr)
      header.need(Header::axisName("position", i, "_m"), ", though a later axis has it");
  }
  return axes;
}

/// Force (N) or torque (N m) of every axis, as columns force_i_N and torque_i_Nm.
std::vector<Column> effortColumns(const Header& header, int axes) {
  std::vector<Column> columns;
  for (int i = 1; i <= axes; ++i) {
    const std::string force = Header::axisName("force", i, "_N"), torque = Header::axisName("torque", i, "_Nm");
    if (header.has(force) || header.has(torque)) {
      columns.push_back(header.need(header.has(force) ? force : torque, ""));
      continue;
    }
    if (!columns.empty())
      header.need(columns.back().name.front() == 't' ? torque : force, ", though other axes have it");
    for (int k = i + 1; k <= axes; ++k) {
      if (header.has(Header::axisName("force", k, "_N"))) header.need(force, ", though other axes have it");
      if (header.has(Header::axisName("torque", k, "_Nm"))) header.need(torque, ", though other axes have it");
    }
    return columns;
  }
  return columns;
}

std::vector<std::string> unitsOf(const std::vector<Column>& columns) {
  std::vector<std::string> units;
  for (const Column& column : columns)
    units.push_back(column.name.substr(column.name.find_last_of('_') + 1));
  return units;
}

struct Columns {
  Column time;
  std::vector<Column> position, reference, velocity, command, force, current, motor, temperature, mocap, home,
      test_pulse;

  std::vector<Column*> all() {
    std::vector<Column*> list = {&time};
    for (auto* group : {&position, &reference, &velocity, &command, &force, &current, &motor, &temperature, &mocap,
                        &home, &test_pulse}) {
      for (Column& column : *group)
        list.push_back(&column);
    }
    return list;
  }
};

Columns findColumns(const Header& header, int axes) {
  Columns c;
  c.time = header.need("time_s", "");
  c.position = signalColumns(header, "position", kPositionUnits, axes);
  c.reference = signalColumns(header, "reference", kPositionUnits, axes);
  c.velocity = signalColumns(header, "velocity", {"_m_per_s", "_rad_per_s"}, axes);
  c.command = signalColumns(header, "command", {"_V"}, axes);
  c.force = effortColumns(header, axes);
  c.current = signalColumns(header, "current", {"_A"}, axes);
  c.motor = signalColumns(header, "motor_position", kPositionUnits, axes);
  c.temperature = signalColumns(header, "temperature", {"_degC"}, axes);
  if (c.command.empty() && c.force.empty() && c.current.empty()) {
    if (c.position.front().name == "position_1_rad")
      header.need("torque_1_Nm", ", and so is current_1_A; one of the two is needed");
    header.need("command_1_V", ", and so is force_1_N; one of the two is needed");
  }
  const char* const mocap[] = {"mocap_x_m", "mocap_z_m", "mocap_theta_rad", "mocap_psi_rad"};
  if (std::any_of(std::begin(mocap), std::end(mocap), [&](const char* name) { return header.has(name); })) {
    for (const char* name : mocap) {
      c.mocap.push_back(header.need(name, ", though the file has other columns of the camera pose"));
      c.mocap.back().may_be_nan = true;
    }
  }
  if (header.has("home_id")) c.home.push_back(header.need("home_id", ""));
  if (header.has("test_pulse")) c.test_pulse.push_back(header.need("test_pulse", ""));
  return c;
}

double limitOf(const Column& column) {
  return column.name == "time_s" ? kLargestTime_s : column.name == "home_id" ? kLargestHome : kLargestValue;
}

/// The recording's one home; a recording during which the axes were homed anew has none.
std::int64_t homeOf(const std::vector<Column>& home, std::vector<std::string>& notes) {
  if (home.empty()) return 0;
  const std::vector<double>& ids = home.front().values;
  if (std::all_of(ids.begin(), ids.end(), [&](double id) { return id == ids.front(); }))
    return static_cast<std::int64_t>(ids.front());
  notes.push_back(
      "home_id changes: the axes were homed anew in between, so that no phase carries over to other recordings.");
  return 0;
}

std::string lineName(const std::string& path, int line) {
  return path + ":" + std::to_string(line) + ": ";
}

bool isWord(Text text) {
  return !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) != 0 && !isNan(text);
}

/// Why this field is refused; empty when it is a value.
std::string parseField(Text text, const Column& column, double limit, double& value) {
  if (column.may_be_nan && isNan(text)) {
    value = std::numeric_limits<double>::quiet_NaN();
    return {};
  }
  const std::optional<double> number = parseFinite(text);
  if (!number)
    return column.name + " is " + inQuotes(text) + ", not a finite number" +
           (column.values.empty() && isWord(text) ? "; if this is a line of units, remove it" : "");
  if (std::abs(*number) > limit) return column.name + " is " + inQuotes(text) + ", beyond +-" + shortNumber(limit);
  if (column.name == "home_id" && *number != std::floor(*number))
    return column.name + " is " + inQuotes(text) + ", not an integer";
  value = *number;
  return {};
}

/// One line into the columns. Returns why it is refused (nothing is stored then), or nothing.
std::string parseRow(const std::vector<Text>& fields, std::size_t expected, const std::vector<Column*>& columns,
                     std::vector<double>& values) {
  if (fields.size() != expected) {
    return std::to_string(fields.size()) + " values where the header has " + std::to_string(expected) + " columns";
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string why = parseField(fields[columns[i]->field], *columns[i], limitOf(*columns[i]), values[i]);
    if (!why.empty()) return why;
  }
  const std::vector<double>& times = columns[0]->values;
  if (!times.empty() && values[0] <= times.back()) {
    return "time_s is " + shortNumber(values[0], 12) + ", not later than " + shortNumber(times.back(), 12) +
           " in the line before";
  }
  return {};
}

Eigen::MatrixXd toMatrix(const std::vector<Column>& columns, int rows) {
  Eigen::MatrixXd out(rows, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    out.col(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::VectorXd>(columns[i].values.data(), rows);
  }
  return out;
}

/// A last line without its line break is whole only if its last value is not visibly shorter than the one above it.
bool lastValueMayBeCut(const std::vector<Text>& fields, std::size_t last_width) {
  return !fields.empty() && fields.back().size() < last_width;
}

/// Next line of `rest` without its line break; `whole` is false when the file ends before a line break.
Text takeLine(Text& rest, bool& whole) {
  const std::size_t end = rest.find('\n');
  whole = end != Text::npos;
  const Text line = rest.substr(0, end);
  rest = whole ? rest.substr(end + 1) : Text{};
  return line;
}

void readRows(Text rest, std::size_t expected, const std::string& path, Columns& columns,
              std::vector<std::string>& notes) {
  const std::vector<Column*> list = columns.all();
  std::vector<double> values(list.size());
  std::vector<Text> fields;
  std::size_t last_width = 0;
  int blank_line = 0;
  for (int line_number = 2; !rest.empty(); ++line_number) {
    bool whole = true;
    const Text line = takeLine(rest, whole);
    if (trimmed(line).empty()) {
      if (blank_line == 0) blank_line = line_number;
      continue;
    }
    if (blank_line != 0) throw InputError(lineName(path, blank_line) + "empty line inside the recording");
    splitInto(line, fields);
    const std::string why = parseRow(fields, expected, list, values);
    if (!whole && (!why.empty() || lastValueMayBeCut(fields, last_width))) {
      notes.push_back("The last line (" + std::to_string(line_number) + ") is cut off and was left out.");
      break;
    }
    if (!why.empty()) throw InputError(lineName(path, line_number) + why);
    for (std::size_t i = 0; i < list.size(); ++i)
      list[i]->values.push_back(values[i]);
    last_width = fields.back().size();
  }
}

/// A column that the user sees in the file is not called missing: what hides it is named.
void requireOwnNames(Text content, Text header_line, const std::string& path) {
  std::vector<Text> fields;
  splitInto(header_line, fields);
  const bool own = std::find(fields.begin(), fields.end(), "time_s") != fields.end() &&
                   trimmed(header_line).find('\r') == Text::npos;
  const std::string why = own ? "" : foreignText(content);
  if (!why.empty()) throw InputError(path + ":1: " + why);
}

}  // namespace

Recording parseRecording(const std::string& content, const std::string& path) {
  Text rest = withoutMark(content);
  const Text text = rest;
  bool whole = true;
  const Text first = takeLine(rest, whole);
  if (trimmed(first).empty())
    throw InputError(path + ": is empty, or its first line is; a recording starts with a header line");
  requireOwnNames(text, first, path);
  const Header header(first, path);

  Recording r;
  r.path = path;
  r.name = std::filesystem::path(path).stem().string();
  r.fingerprint = fingerprint(content);
  r.axes = countAxes(header);
  Columns columns = findColumns(header, r.axes);
  readRows(rest, header.count(), path, columns, r.notes);
  r.home_id = homeOf(columns.home, r.notes);
  r.time_s = std::move(columns.time.values);
  if (r.time_s.empty()) throw InputError(path + ": has a header but no complete row");
  r.position_unit = unitsOf(columns.position);
  r.force_unit = unitsOf(columns.force);
  r.position_m = toMatrix(columns.position, r.rows());
  r.reference_m = toMatrix(columns.reference, r.rows());
  r.velocity_m_per_s = toMatrix(columns.velocity, r.rows());
  r.command_V = toMatrix(columns.command, r.rows());
  r.force_N = toMatrix(columns.force, r.rows());
  r.current_A = toMatrix(columns.current, r.rows());
  r.motor_m = toMatrix(columns.motor, r.rows());
  r.temperature_degC = toMatrix(columns.temperature, r.rows());
  r.mocap = toMatrix(columns.mocap, r.rows());
  if (!columns.test_pulse.empty()) r.test_pulse = toMatrix(columns.test_pulse, r.rows()).col(0);
  return r;
}

Recording loadRecording(const std::string& path) {
  return parseRecording(readFile(path), path);
}

Eigen::MatrixXd commandedForce(const Recording& r, const std::vector<double>& force_per_volt_N) {
  const Eigen::Map<const Eigen::RowVectorXd> factor(force_per_volt_N.data(),
                                                    static_cast<Eigen::Index>(force_per_volt_N.size()));
  if (r.command_V.cols() == 0 && r.force_N.cols() == 0)
    throw InputError(r.path + ":1: column command_1_V is missing, and so is force_1_N; one of the two is needed");
  if (r.command_V.cols() == 0) return r.force_N;
  const Eigen::MatrixXd from_command = r.command_V.array().rowwise() * factor.array();
  if (r.force_N.cols() == 0) return from_command;
  const double slack = 1.0 + 1e-3;  // values are printed with a few digits
  for (int row = 0; row < r.rows(); ++row) {
    for (int i = 0; i < r.axes; ++i) {
      const double limit = std::abs(factor(i)) * kDacStep_V * slack;
      if (std::abs(r.force_N(row, i) - from_command(row, i)) <= limit) continue;
      const std::string axis = std::to_string(i + 1);
      throw InputError(
          lineName(r.path, Recording::line(row)) + "force_" + axis + "_N " + shortNumber(r.force_N(row, i)) +
          " N and command_" + axis + "_V " + shortNumber(r.command_V(row, i)) + " V (" +
          shortNumber(from_command(row, i)) + " N at " + shortNumber(factor(i)) +
          " N/V) disagree by more than one DAC step; correct the robot file's force_per_volt_N or remove one column");
    }
  }
  return r.force_N;
}

void requireAxes(const Recording& recording, int axes, const std::string& robot_path) {
  if (recording.axes == axes) return;
  throw InputError(recording.path + ": records " + std::to_string(recording.axes) + " actuators, but the robot of " +
                   robot_path + " has " + std::to_string(axes));
}

}  // namespace knee_robot::recording
