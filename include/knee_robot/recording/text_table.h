#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "knee_robot/base/strict_yaml.h"

namespace knee_robot::recording {

/// How a foreign table is written.
struct TableFormat {
  char separator = 0;  ///< 0: found in the first line (tab, semicolon, comma, else blanks); ' ': any run of blanks
  bool header = true;  ///< the first line names the columns
  bool decimal_comma = false;  ///< 0,5 instead of 0.5
  int skip_lines = 0;          ///< lines in front of the header
};

/// Keys separator, decimal, header and skip_lines of a map file; each optional.
TableFormat readTableFormat(StrictMap& file);

/// A table of another program: one line a row, columns by name or number. CRLF, blanks around values, a byte order mark
/// and empty lines at the end are accepted. A last line that is cut off (without its line break, and with fewer values
/// or a shorter last number than the line above) is left out, and notes() say so. InputError (file, line) for an empty
/// table, a doubled column name that is asked for, an empty line inside, a row with another number of values than the
/// first line.
class TextTable {
 public:
  static TextTable load(const std::string& path, const TableFormat& format = {});
  /// `path` stands for the file in messages.
  TextTable(std::string content, std::string path, const TableFormat& format = {});

  TextTable(const TextTable&) = delete;  // rows_ point into content_
  TextTable& operator=(const TextTable&) = delete;

  const std::string& path() const { return path_; }
  int rows() const { return static_cast<int>(rows_.size()); }
  int columns() const { return columns_; }
  /// What was left out.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Names in the header; empty without one.
  const std::vector<std::string>& names() const { return names_; }
  /// Line of the file that holds this row, for messages.
  int line(int row) const { return first_line_ + row; }
  /// Index of the column called `name`, or, without a header, of the column with this number (from 1). InputError that
  /// names what there is when there is none.
  int find(const std::string& name) const;

  /// Finite numbers of a column, one a row. With `nan_allowed`, `nan` and an empty field are nan. InputError (file,
  /// line, column, value) for anything else.
  std::vector<double> numbers(int column, bool nan_allowed = false) const;
  /// Whole numbers of a column within [minimum, maximum], exactly.
  std::vector<std::int64_t> integers(int column, std::int64_t minimum, std::int64_t maximum) const;
  /// Throws InputError "FILE:LINE: column NAME: SENTENCE".
  [[noreturn]] void refuse(int row, int column, const std::string& sentence) const;

 private:
  std::string_view field(int row, int column) const;
  bool isCut(std::string_view line) const;

  std::string content_, path_;
  TableFormat format_;
  std::vector<std::string> names_, notes_;
  std::vector<std::string_view> rows_;
  int columns_ = 0;
  int first_line_ = 1;
};

}  // namespace knee_robot::recording
