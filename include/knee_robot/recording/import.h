#pragma once

#include <string>
#include <vector>

#include "knee_robot/recording/text_table.h"

namespace knee_robot::recording {

/// A recording (docs/contract.md, section 2) made of other recorders' files, not yet written.
struct Imported {
  std::string csv;  ///< content of the recording file; parseRecording accepts it
  int rows = 0;
  std::vector<std::string> notes;  ///< what was done, above all to the time axis, one sentence each
};

/// A folder with one table per signal, each row with its own stamp in the columns time_sec and time_nanosec; the other
/// columns are the axes in order. An empty name: this signal is left out, even if the folder has it.
struct SignalFolder {
  std::string path;
  std::string position = "joint_position.txt";  ///< m; needed
  std::string command = "control_action.txt";   ///< needed
  std::string reference = "ref_pose.txt";       ///< m
  std::string velocity = "joint_velocity.txt";  ///< m/s
  std::string pose = "x_coord.txt";             ///< Xm, Zm (m), theta, psi (rad) as the recorder computed it
  std::string command_unit;                     ///< "N" (force_i_N) or "V" (command_i_V)
};

/// Aligns such a folder. Position's stamps are the rows. Every other signal was written after its row's position: a row
/// takes the first value whose stamp lies in [its own, the next position's). Rows in front of the first, and after the
/// last, that all signals have are dropped; inside, the value before is held, and counted. Leading position rows before
/// a break of the stamps (a jump back, or more than 20 periods ahead, within the first ten rows) are stale and dropped.
/// Time starts at zero.
/// InputError (file, line, column) for what cannot be read; Refusal when more than a tenth of the rows has to hold:
/// then the files do not belong together.
Imported importFolder(const SignalFolder& folder);

/// One column of a foreign table and what it becomes: value = scale * unit * number + offset.
struct ColumnMapping {
  std::string from;  ///< its name there, or its number (from 1) in a table without header
  std::string to;    ///< a column of a recording (time_s, position_1_m, ...)
  std::string unit;  ///< of the foreign numbers; empty: the SI unit of `to`. `counts` needs a scale (m per count)
  double scale = 1.0;
  double offset = 0.0;  ///< in the unit of `to`
};

/// How a foreign table becomes a recording.
struct ColumnMap {
  TableFormat format;
  std::vector<ColumnMapping> columns;
};

/// Reads a map file (YAML, strict):
///
///     separator: tab            # or comma, semicolon, blank; found in the first line when left out
///     decimal: comma            # point when left out
///     header: true
///     skip_lines: 0             # in front of the header
///     columns:
///       - {from: "t [ms]", to: time_s, unit: ms}
///       - {from: enc1, to: position_1_m, unit: counts, scale: 5e-6, offset: 0.6}
ColumnMap loadColumnMap(const std::string& path);
/// The same from memory; `path` stands for the file in messages.
ColumnMap parseColumnMap(const std::string& text, const std::string& path);

/// One mapping from a command line: "FROM=TO[,UNIT[,SCALE[,OFFSET]]]". InputError naming the text.
ColumnMapping parseMapping(const std::string& text);

/// Applies a map to a table. time_s may be given by several columns (seconds and nanoseconds), which are added; time
/// starts at zero. InputError for an unknown column or unit, time that does not increase, and everything that
/// parseRecording refuses.
Imported importTable(const TextTable& table, const ColumnMap& map);

/// Writes the recording. InputError when `path` exists already: a recording is never overwritten.
void writeImported(const Imported& imported, const std::string& path);

}  // namespace knee_robot::recording
