#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>

#include "import_rows.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/quantile.h"
#include "knee_robot/recording/import.h"

namespace knee_robot::recording {
namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kSecond = 1000000000;
constexpr int kStaleAtMost = 10;
constexpr int kBreakPeriods = 20;
constexpr double kHeldAtMost = 0.1;

/// One file of the folder: stamps in ns and one column an axis.
struct Stamped {
  std::string file;
  std::vector<std::int64_t> stamp_ns;
  std::vector<std::vector<double>> values;
};

Stamped loadStamped(const std::string& path, std::vector<std::string>& notes) {
  const TextTable table = TextTable::load(path);
  notes.insert(notes.end(), table.notes().begin(), table.notes().end());
  const int seconds = table.find("time_sec"), nanoseconds = table.find("time_nanosec");
  const std::vector<std::int64_t> s = table.integers(seconds, 0, 9000000000);
  const std::vector<std::int64_t> ns = table.integers(nanoseconds, 0, kSecond - 1);
  Stamped signal;
  signal.file = fs::path(path).filename().string();
  for (std::size_t i = 0; i < s.size(); ++i)
    signal.stamp_ns.push_back(s[i] * kSecond + ns[i]);
  for (int column = 0; column < table.columns(); ++column) {
    if (column != seconds && column != nanoseconds) signal.values.push_back(table.numbers(column));
  }
  if (signal.values.empty()) throw InputError(path + ": has stamps but no values");
  return signal;
}

std::int64_t medianInterval(const std::vector<std::int64_t>& stamps) {
  std::vector<std::int64_t> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    intervals.push_back(stamps[i] - stamps[i - 1]);
  return median(std::move(intervals));
}

/// Leading rows before a break of the stamps; then the stamps must increase.
std::size_t staleRows(const Stamped& signal, const std::string& path) {
  const std::vector<std::int64_t>& t = signal.stamp_ns;
  const std::int64_t period = medianInterval(t);
  std::size_t stale = 0;
  for (std::size_t i = 1; i < std::min<std::size_t>(t.size(), kStaleAtMost + 1); ++i) {
    if (t[i] <= t[i - 1] || t[i] - t[i - 1] > kBreakPeriods * period) stale = i;
  }
  for (std::size_t i = stale + 1; i < t.size(); ++i) {
    if (t[i] <= t[i - 1]) {
      throw InputError(path + ":" + std::to_string(i + 2) + ": the stamp is not later than that of the line before");
    }
  }
  return stale;
}

void dropFront(Stamped& signal, std::size_t count) {
  const auto n = static_cast<std::ptrdiff_t>(count);
  signal.stamp_ns.erase(signal.stamp_ns.begin(), signal.stamp_ns.begin() + n);
  for (std::vector<double>& column : signal.values)
    column.erase(column.begin(), column.begin() + n);
}

std::string milliseconds(std::int64_t ns) {
  return shortNumber(1e-6 * static_cast<double>(ns), 4) + " ms";
}

Stamped loadClean(const SignalFolder& folder, const std::string& file, std::size_t axes,
                  std::vector<std::string>& notes) {
  const std::string path = folder.path + "/" + file;
  Stamped signal = loadStamped(path, notes);
  if (axes != 0 && signal.values.size() != axes) {
    throw InputError(path + ":1: " + std::to_string(signal.values.size()) + " values a row where " + folder.position +
                     " has " + std::to_string(axes));
  }
  if (signal.stamp_ns.size() < 2) throw InputError(path + ": has a single row; at least two are needed");
  const std::size_t stale = staleRows(signal, path);
  dropFront(signal, stale);
  if (signal.stamp_ns.size() < 2) throw InputError(path + ": no two rows have stamps that go together");
  if (stale > 0) notes.push_back(file + ": the first " + std::to_string(stale) + " rows were stale and left out.");
  return signal;
}

/// For every position row the row of `signal` that belongs to it: the first stamp in [its own, the next one's). -1:
/// none.
std::vector<int> partners(const std::vector<std::int64_t>& position, const Stamped& signal) {
  const std::int64_t period = medianInterval(position);
  std::vector<int> out;
  for (std::size_t i = 0; i < position.size(); ++i) {
    const std::int64_t next = i + 1 < position.size() ? position[i + 1] : position[i] + period;
    const auto found = std::lower_bound(signal.stamp_ns.begin(), signal.stamp_ns.end(), position[i]);
    out.push_back(found != signal.stamp_ns.end() && *found < next ? static_cast<int>(found - signal.stamp_ns.begin())
                                                                  : -1);
  }
  return out;
}

struct Part {
  Stamped signal;
  std::vector<std::string> names;
  std::vector<int> row;  ///< per position row
};

/// How long after the position the values were written, and how many rows had none of their own.
void holdAndReport(Part& part, const std::vector<std::int64_t>& position, std::size_t first, std::size_t last,
                   const std::string& folder, std::vector<std::string>& notes) {
  std::vector<std::int64_t> delays;
  std::size_t held = 0;
  for (std::size_t i = first; i <= last; ++i) {
    if (part.row[i] >= 0) {
      delays.push_back(part.signal.stamp_ns[static_cast<std::size_t>(part.row[i])] - position[i]);
    } else {
      part.row[i] = part.row[i - 1];
      ++held;
    }
  }
  const std::size_t rows = last - first + 1;
  if (static_cast<double>(held) > kHeldAtMost * static_cast<double>(rows)) {
    throw Refusal(
        folder + "/" + part.signal.file + ": " + std::to_string(held) + " of " + std::to_string(rows) +
        " rows have no value of their own; at most a tenth may be held, so these files do not belong together");
  }
  std::sort(delays.begin(), delays.end());
  notes.push_back(part.signal.file + ": written " + milliseconds(delays.front()) + " to " +
                  milliseconds(delays.back()) + " (median " + milliseconds(delays[delays.size() / 2]) +
                  ") after its row's position; " +
                  (held == 0 ? "every row has its own value." : "held over " + std::to_string(held) + " rows."));
}

bool complete(const std::vector<Part>& parts, std::size_t row) {
  return std::all_of(parts.begin(), parts.end(), [&](const Part& p) { return p.row[row] >= 0; });
}

std::vector<std::string> axisNames(const char* signal, const char* unit, std::size_t axes) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= axes; ++i)
    names.push_back(std::string(signal) + "_" + std::to_string(i) + unit);
  return names;
}

std::vector<Part> loadParts(const SignalFolder& folder, std::size_t axes, std::vector<std::string>& notes) {
  std::vector<Part> parts;
  const auto add = [&](const std::string& file, std::vector<std::string> names, bool needed) {
    if (file.empty()) return;
    if (!needed && !fs::exists(folder.path + "/" + file)) {
      notes.push_back("There is no " + file + ", so " + names.front() + " and its like are left out.");
      return;
    }
    Stamped signal = loadClean(folder, file, names.size(), notes);
    parts.push_back({std::move(signal), std::move(names), {}});
  };
  add(folder.reference, axisNames("reference", "_m", axes), false);
  add(folder.velocity, axisNames("velocity", "_m_per_s", axes), false);
  const bool force = folder.command_unit == "N";
  add(folder.command, axisNames(force ? "force" : "command", force ? "_N" : "_V", axes), true);
  if (axes == 4) add(folder.pose, {"pose_x_m", "pose_z_m", "pose_theta_rad", "pose_psi_rad"}, false);
  return parts;
}

/// "12.345678901" exactly.
std::string seconds(std::int64_t ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%09lld", static_cast<long long>(ns / kSecond),
                static_cast<long long>(ns % kSecond));
  return text;
}

Imported assemble(const Stamped& position, const std::vector<Part>& parts, std::size_t first, std::size_t last) {
  std::vector<std::string> names = {"time_s"};
  for (const std::string& name : axisNames("position", "_m", position.values.size()))
    names.push_back(name);
  for (const Part& part : parts)
    names.insert(names.end(), part.names.begin(), part.names.end());
  Imported out;
  out.csv = headerLine(names);
  for (std::size_t i = first; i <= last; ++i) {
    out.csv += seconds(position.stamp_ns[i] - position.stamp_ns[first]);
    for (const std::vector<double>& column : position.values)
      out.csv += "," + exactNumber(column[i]);
    for (const Part& part : parts) {
      for (const std::vector<double>& column : part.signal.values)
        out.csv += "," + exactNumber(column[static_cast<std::size_t>(part.row[i])]);
    }
    out.csv += "\n";
    ++out.rows;
  }
  return out;
}

std::string timeNote(const Stamped& position, std::size_t first, std::size_t last) {
  std::vector<std::int64_t> t(position.stamp_ns.begin() + static_cast<std::ptrdiff_t>(first),
                              position.stamp_ns.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  std::int64_t shortest = t[1] - t[0], longest = shortest;
  for (std::size_t i = 1; i < t.size(); ++i) {
    shortest = std::min(shortest, t[i] - t[i - 1]);
    longest = std::max(longest, t[i] - t[i - 1]);
  }
  return "Time is that of " + position.file + " minus " + seconds(t.front()) + " s: " + std::to_string(t.size()) +
         " rows, " + milliseconds(shortest) + " to " + milliseconds(longest) + " apart (median " +
         milliseconds(medianInterval(t)) + "); nothing was resampled. " + std::to_string(first) +
         " rows before it and " + std::to_string(position.stamp_ns.size() - 1 - last) +
         " after it were left out because another signal has no value for them.";
}

void noteOtherFiles(const SignalFolder& folder, std::vector<std::string>& notes) {
  std::vector<std::string> others;
  for (const auto& entry : fs::directory_iterator(folder.path)) {
    const std::string name = entry.path().filename().string();
    const auto used = {folder.position, folder.command, folder.reference, folder.velocity, folder.pose};
    if (std::find(used.begin(), used.end(), name) == used.end()) others.push_back(name);
  }
  std::sort(others.begin(), others.end());
  for (const std::string& name : others)
    notes.push_back(name + " was not imported.");
}

}  // namespace

Imported importFolder(const SignalFolder& folder) {
  if (!fs::is_directory(folder.path)) throw InputError(folder.path + ": is not a folder");
  if (folder.command_unit != "N" && folder.command_unit != "V") {
    throw InputError("the unit of " + folder.command + " must be N or V, not '" + folder.command_unit + "'");
  }
  std::vector<std::string> notes;
  const Stamped position = loadClean(folder, folder.position, 0, notes);
  if (position.values.size() > 4) throw InputError(folder.path + "/" + folder.position + ":1: more than four axes");
  std::vector<Part> parts = loadParts(folder, position.values.size(), notes);
  for (Part& part : parts)
    part.row = partners(position.stamp_ns, part.signal);
  std::size_t first = 0, last = position.stamp_ns.size();
  while (first < last && !complete(parts, first))
    ++first;
  while (last > first && !complete(parts, last - 1))
    --last;
  if (last < first + 2) {
    throw Refusal(folder.path +
                  ": there is no stretch of time in which all signals have values; the files do not belong together");
  }
  --last;
  std::vector<std::string> delays;
  for (Part& part : parts)
    holdAndReport(part, position.stamp_ns, first, last, folder.path, delays);
  Imported out = assemble(position, parts, first, last);
  out.notes = {timeNote(position, first, last)};
  out.notes.insert(out.notes.end(), notes.begin(), notes.end());
  out.notes.insert(out.notes.end(), delays.begin(), delays.end());
  noteOtherFiles(folder, out.notes);
  requireRecording(out, folder.path);
  return out;
}

}  // namespace knee_robot::recording
