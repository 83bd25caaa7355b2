#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "import_rows.h"
#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/base/words.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::recording {
namespace {

constexpr int kMostImported = 12;

/// Factors to the SI unit that the target's name ends in. `counts` is a length whose scale says metres per count.
const std::map<std::string, std::map<std::string, double>>& unitsByEnding() {
  static const std::map<std::string, std::map<std::string, double>> kUnits = {
      {"_rad_per_s", {{"rad/s", 1.0}, {"mrad/s", 1e-3}, {"deg/s", kDegree}, {"rpm", 6.0 * kDegree}, {"counts/s", 1.0}}},
      {"_m_per_s", {{"m/s", 1.0}, {"mm/s", 1e-3}, {"um/s", 1e-6}, {"counts/s", 1.0}}},
      {"_s", {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}, {"min", 60.0}}},
      {"_m", {{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"counts", 1.0}}},
      {"_V", {{"V", 1.0}, {"mV", 1e-3}}},
      {"_N", {{"N", 1.0}, {"kN", 1e3}, {"mN", 1e-3}}},
      {"_Nm", {{"Nm", 1.0}, {"kNm", 1e3}, {"mNm", 1e-3}}},
      {"_A", {{"A", 1.0}, {"mA", 1e-3}}},
      {"_degC", {{"degC", 1.0}}},
      {"_rad", {{"rad", 1.0}, {"mrad", 1e-3}, {"deg", kDegree}, {"counts", 1.0}}}};
  return kUnits;
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Names that a recording may have, without those of cameras.
bool isActuatorColumn(const std::string& name) {
  for (const char* form : {"position_?_m", "reference_?_m", "velocity_?_m_per_s", "command_?_V", "force_?_N",
                           "position_?_rad", "reference_?_rad", "velocity_?_rad_per_s", "torque_?_Nm", "current_?_A",
                           "motor_position_?_m", "motor_position_?_rad", "temperature_?_degC"}) {
    const std::string pattern = form;
    for (int axis = 1; axis <= kMostImported; ++axis) {
      std::string candidate = pattern;
      if (candidate.replace(candidate.find('?'), 1, std::to_string(axis)) == name) return true;
    }
  }
  return false;
}

bool isCameraColumn(const std::string& name) {
  return name == "mocap_x_m" || name == "mocap_z_m" || name == "mocap_theta_rad" || name == "mocap_psi_rad";
}

/// Why this mapping is refused; empty when it is sound. `factor` takes the unit's factor.
std::string whyNot(const ColumnMapping& m, double& factor) {
  if (m.to != "time_s" && !isActuatorColumn(m.to) && !isCameraColumn(m.to)) {
    return "'" + m.to +
           "' is no column of a recording (time_s; reference_i_m, position_i_m, velocity_i_m_per_s, command_i_V, "
           "force_i_N; of a chain reference_i_rad, position_i_rad, velocity_i_rad_per_s, torque_i_Nm, current_i_A, "
           "motor_position_i_m, motor_position_i_rad, temperature_i_degC; with i = 1 to 12; mocap_x_m, mocap_z_m, "
           "mocap_theta_rad, mocap_psi_rad)";
  }
  if (!std::isfinite(m.scale) || m.scale == 0.0 || !std::isfinite(m.offset))
    return "scale and offset must be finite, and scale not 0";
  // The longest ending decides: velocity_1_m_per_s ends in _s too.
  const std::map<std::string, double>* units = nullptr;
  std::size_t longest = 0;
  for (const auto& [ending, list] : unitsByEnding()) {
    if (endsWith(m.to, ending) && ending.size() > longest) {
      units = &list;
      longest = ending.size();
    }
  }
  factor = 1.0;
  if (m.unit.empty()) return {};
  const auto found = units->find(m.unit);
  if (found == units->end())
    return "the unit '" + m.unit + "' does not fit " + m.to +
           "; known: " + joined(*units, [](const auto& one) { return one.first; });
  if (m.unit.rfind("counts", 0) == 0 && m.scale == 1.0)
    return "counts need a scale (metres or radians per count) other than 1";
  factor = found->second;
  return {};
}

double factorOf(const ColumnMapping& m) {
  double factor = 1.0;
  const std::string why = whyNot(m, factor);
  if (!why.empty()) throw InputError("column '" + m.from + "': " + why);
  return factor;
}

/// Sum of all time columns, each counted from its own first value so that large stamps keep their last digits.
std::vector<double> timeOf(const TextTable& table, const ColumnMap& map, std::string& note) {
  std::vector<double> time;
  int shown = 0;
  for (const ColumnMapping& m : map.columns) {
    if (m.to != "time_s") continue;
    const int column = table.find(m.from);
    const std::vector<double> values = table.numbers(column);
    const double factor = factorOf(m) * m.scale;
    time.resize(values.size(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i)
      time[i] += factor * (values[i] - values[0]);
    note += (note.empty() ? "Time is " : " + ") + shortNumber(factor) + " s * '" + m.from + "', which starts at " +
            shortNumber(values[0], 12);
    shown = column;
  }
  if (time.empty()) throw InputError(table.path() + ": no column is mapped to time_s");
  // Stamps as numbers carry rounding of their own; a nanosecond is far below any recorder's jitter.
  for (double& t : time)
    t = std::round(t * 1e9) * 1e-9;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(time[i] > time[i - 1]))
      table.refuse(static_cast<int>(i), shown, "time does not increase from the row before");
  }
  return time;
}

std::string intervalNote(const std::vector<double>& time) {
  if (time.size() < 2) return " and is a single row.";
  double shortest = time[1] - time[0], longest = shortest;
  for (std::size_t i = 1; i < time.size(); ++i) {
    shortest = std::min(shortest, time[i] - time[i - 1]);
    longest = std::max(longest, time[i] - time[i - 1]);
  }
  return "; counted from the first row: " + std::to_string(time.size()) + " rows, " + shortNumber(1e3 * shortest, 4) +
         " to " + shortNumber(1e3 * longest, 4) + " ms apart (median " + shortNumber(1e3 * medianPeriod(time), 4) +
         " ms). Nothing was resampled, no signal was shifted.";
}

void refuseDoubled(const ColumnMap& map) {
  for (std::size_t i = 0; i < map.columns.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (map.columns[i].to == map.columns[k].to && map.columns[i].to != "time_s") {
        throw InputError("columns '" + map.columns[k].from + "' and '" + map.columns[i].from + "' both become " +
                         map.columns[i].to);
      }
    }
  }
}

ColumnMapping readMapping(StrictMap& entry) {
  ColumnMapping m;
  m.from = entry.text("from");
  m.to = entry.text("to");
  m.unit = entry.textOr("unit", "");
  m.scale = entry.numberOr("scale", 1.0, -1e12, 1e12);
  m.offset = entry.numberOr("offset", 0.0, -1e6, 1e6);
  entry.finish();
  double factor = 1.0;
  const std::string why = whyNot(m, factor);
  if (!why.empty()) entry.refuse("to", why);
  return m;
}

}  // namespace

ColumnMap parseColumnMap(const std::string& text, const std::string& path) {
  StrictMap file = StrictMap::parse(text, path);
  ColumnMap map;
  map.format = readTableFormat(file);
  for (StrictMap& entry : file.maps("columns"))
    map.columns.push_back(readMapping(entry));
  file.finish();
  return map;
}

ColumnMap loadColumnMap(const std::string& path) {
  return parseColumnMap(readFile(path, 1u << 20), path);
}

ColumnMapping parseMapping(const std::string& text) {
  const auto bad = [&](const std::string& why) {
    return InputError("--column '" + text + "': " + why + "; write FROM=TO[,UNIT[,SCALE[,OFFSET]]]");
  };
  const std::size_t equal = text.rfind('=');
  if (equal == std::string::npos || equal == 0) throw bad("no name before '='");
  ColumnMapping m;
  m.from = text.substr(0, equal);
  std::vector<std::string> parts;
  for (std::size_t at = equal + 1; true;) {
    const std::size_t comma = text.find(',', at);
    parts.push_back(text.substr(at, comma == std::string::npos ? comma : comma - at));
    if (comma == std::string::npos) break;
    at = comma + 1;
  }
  if (parts.size() > 4) throw bad("too many parts");
  m.to = parts[0];
  if (parts.size() > 1) m.unit = parts[1];
  for (std::size_t i = 2; i < parts.size(); ++i) {
    const auto value = parseFinite(parts[i]);
    if (!value) throw bad("'" + parts[i] + "' is not a finite number");
    (i == 2 ? m.scale : m.offset) = *value;
  }
  double factor = 1.0;
  const std::string why = whyNot(m, factor);
  if (!why.empty()) throw bad(why);
  return m;
}

Imported importTable(const TextTable& table, const ColumnMap& map) {
  refuseDoubled(map);
  std::string note;
  const std::vector<double> time = timeOf(table, map, note);
  std::vector<std::string> names = {"time_s"};
  std::vector<std::vector<double>> columns = {time};
  Imported out;
  out.notes = table.notes();
  out.notes.push_back(note + intervalNote(time));
  for (const ColumnMapping& m : map.columns) {
    if (m.to == "time_s") continue;
    const double factor = factorOf(m) * m.scale;
    std::vector<double> values = table.numbers(table.find(m.from), isCameraColumn(m.to));
    for (double& value : values)
      value = factor * value + m.offset;
    names.push_back(m.to);
    columns.push_back(std::move(values));
    out.notes.push_back("'" + m.from + "' became " + m.to + (factor == 1.0 ? "" : ", times " + shortNumber(factor, 9)) +
                        (m.offset == 0.0 ? "" : ", plus " + shortNumber(m.offset, 9)) + ".");
  }
  out.csv = headerLine(names);
  for (std::size_t i = 0; i < time.size(); ++i) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double value = columns[c][i];
      out.csv += (c == 0 ? "" : ",") + (std::isnan(value) ? std::string("nan") : exactNumber(value));
    }
    out.csv += "\n";
  }
  out.rows = static_cast<int>(time.size());
  requireRecording(out, table.path());
  return out;
}

void requireRecording(const Imported& imported, const std::string& source) {
  parseRecording(imported.csv, source + " (as imported)");
}

void writeImported(const Imported& imported, const std::string& path) {
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::symlink_status(path, error))) {
    throw InputError(path + ": exists already; a recording is never overwritten, so choose another name");
  }
  writeFileAtomically(path, imported.csv);
}

}  // namespace knee_robot::recording
