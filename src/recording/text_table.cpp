#include "knee_robot/recording/text_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"

namespace knee_robot::recording {
namespace {

using Text = std::string_view;

constexpr int kWidestTable = 10000;

/// A field in quotes (RFC 4180), which may hold the separator; false when `rest` does not begin with one.
bool takeQuoted(Text& rest, char separator, Text& field, bool& more) {
  const auto withoutBlanks = [&](Text text) {
    const std::size_t from = text.find_first_not_of(separator == '\t' ? " \r" : " \t\r");
    return from == Text::npos ? Text{} : text.substr(from);
  };
  const Text start = withoutBlanks(rest);
  if (start.empty() || start.front() != '"') return false;
  std::size_t end = start.find('"', 1);
  while (end != Text::npos && start.substr(end + 1, 1) == "\"")  // a doubled one stands for itself
    end = start.find('"', end + 2);
  if (end == Text::npos) return false;
  const Text after = withoutBlanks(start.substr(end + 1));
  if (!after.empty() && after.front() != separator) return false;
  field = trimmed(start.substr(1, end - 1));
  more = !after.empty();
  if (more) rest = after.substr(1);
  return true;
}

/// Takes the first field off `rest`; false when there is none left. `rest` is trimmed for blank-separated tables.
bool takeField(Text& rest, char separator, Text& field, bool& more) {
  if (!more) return false;
  if (separator == ' ') {
    rest = trimmed(rest);
    if (rest.empty()) return more = false;
    const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
    field = rest.substr(0, end);
    rest.remove_prefix(end);
    return true;
  }
  if (takeQuoted(rest, separator, field, more)) return true;
  const std::size_t end = rest.find(separator);
  field = trimmed(rest.substr(0, end));
  more = end != Text::npos;
  if (more) rest.remove_prefix(end + 1);
  return true;
}

/// A header word without its quotes, doubled ones inside single again.
std::string unquoted(Text text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    out += text[i];
    if (text[i] == '"' && text.substr(i + 1, 1) == "\"") ++i;
  }
  return out;
}

/// Without what stands in quotes.
std::string outsideQuotes(Text line) {
  std::string out;
  bool inside = false;
  for (const char c : line) {
    if (c == '"') inside = !inside;
    if (!inside) out += c;
  }
  return out;
}

char separatorOf(Text whole, bool decimal_comma) {
  const std::string line = outsideQuotes(whole);
  for (const char c : {'\t', ';', ','}) {
    if (c == ',' && decimal_comma) continue;
    if (trimmed(line).find(c) != Text::npos) return c;
  }
  return ' ';
}

int countFields(Text line, char separator) {
  int count = 0;
  Text field;
  for (bool more = true; takeField(line, separator, field, more);)
    ++count;
  return count;
}

Text lastField(Text line, char separator) {
  Text field;
  for (bool more = true; takeField(line, separator, field, more);) {
  }
  return field;
}

std::vector<std::string> headerNames(Text line, char separator) {
  std::vector<std::string> names;
  Text field;
  for (bool more = true; takeField(line, separator, field, more);)
    names.emplace_back(unquoted(field));
  return names;
}

std::optional<double> parseWith(Text text, bool decimal_comma) {
  if (!decimal_comma) return parseFinite(text);
  std::string copy(text);
  std::replace(copy.begin(), copy.end(), ',', '.');
  return parseFinite(copy);
}

}  // namespace

TableFormat readTableFormat(StrictMap& file) {
  TableFormat format;
  const std::string separator = file.choiceOr("separator", "", {"", "tab", "comma", "semicolon", "blank"});
  if (!separator.empty())
    format.separator = separator == "tab" ? '\t' : separator == "comma" ? ',' : separator == "blank" ? ' ' : ';';
  format.decimal_comma = file.choiceOr("decimal", "point", {"point", "comma"}) == "comma";
  format.header = file.flagOr("header", true);
  format.skip_lines = file.integerOr("skip_lines", 0, 0, 100000);
  return format;
}

TextTable TextTable::load(const std::string& path, const TableFormat& format) {
  return TextTable(readFile(path), path, format);
}

TextTable::TextTable(std::string content, std::string path, const TableFormat& format)
    : content_(std::move(content)), path_(std::move(path)), format_(format) {
  Text rest = withoutMark(content_);
  int blank_line = 0;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    const bool whole = end != Text::npos;
    const Text line = rest.substr(0, end);
    rest = end == Text::npos ? Text{} : rest.substr(end + 1);
    if (number <= format_.skip_lines) continue;
    const std::string here = path_ + ":" + std::to_string(number) + ": ";
    if (trimmed(line).empty()) {
      if (blank_line == 0) blank_line = number;
      continue;
    }
    if (blank_line != 0) throw InputError(path_ + ":" + std::to_string(blank_line) + ": empty line inside the table");
    if (columns_ == 0) {
      if (format_.separator == 0) format_.separator = separatorOf(line, format_.decimal_comma);
      columns_ = countFields(line, format_.separator);
      if (columns_ > kWidestTable) throw InputError(here + "more than 10000 columns; this is no table of signals");
      first_line_ = number + (format_.header ? 1 : 0);
      if (format_.header) {
        names_ = headerNames(line, format_.separator);
        continue;
      }
    }
    if (!whole && isCut(line)) {
      notes_.push_back(path_ + ": the last line (" + std::to_string(number) + ") is cut off and was left out.");
      break;
    }
    const int found = countFields(line, format_.separator);
    if (found != columns_) {
      throw InputError(here + std::to_string(found) + " values where the first line has " + std::to_string(columns_));
    }
    rows_.push_back(line);
  }
  if (rows_.empty()) throw InputError(path_ + ": holds no rows" + (format_.header ? " after its header" : ""));
}

/// Of a last line without its line break. Its last number may have lost digits: it is whole only if it is not visibly
/// shorter than the one above it, as in recordings.
bool TextTable::isCut(Text line) const {
  if (rows_.empty()) return false;
  if (countFields(line, format_.separator) < columns_) return true;
  const Text last = lastField(line, format_.separator), above = lastField(rows_.back(), format_.separator);
  return parseWith(above, format_.decimal_comma).has_value() && last.size() < above.size();
}

int TextTable::find(const std::string& name) const {
  if (!format_.header) {
    const std::optional<double> number = parseFinite(name);
    if (number && *number >= 1 && *number <= columns_ && *number == std::floor(*number)) {
      return static_cast<int>(*number) - 1;
    }
    throw InputError(path_ + ": has no header, so '" + name + "' must be a column number from 1 to " +
                     std::to_string(columns_));
  }
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found != names_.end() && std::find(found + 1, names_.end(), name) == names_.end()) {
    return static_cast<int>(found - names_.begin());
  }
  if (found != names_.end())
    throw InputError(path_ + ":" + std::to_string(first_line_ - 1) + ": column " + name + " occurs twice");
  std::string known;
  for (std::size_t i = 0; i < std::min<std::size_t>(names_.size(), 20); ++i)
    known += (i == 0 ? "" : ", ") + inQuotes(names_[i]);
  throw InputError(path_ + ":" + std::to_string(first_line_ - 1) + ": column " + inQuotes(name) +
                   " is missing; there are " + known + (names_.size() > 20 ? ", ..." : ""));
}

Text TextTable::field(int row, int column) const {
  Text rest = rows_[static_cast<std::size_t>(row)], field;
  bool more = true;
  for (int i = 0; i <= column; ++i)
    takeField(rest, format_.separator, field, more);
  return field;
}

std::vector<double> TextTable::numbers(int column, bool nan_allowed) const {
  std::vector<double> values;
  values.reserve(rows_.size());
  for (int row = 0; row < rows(); ++row) {
    const Text text = field(row, column);
    if (nan_allowed && (text.empty() || isNan(text))) {
      values.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const std::optional<double> value = parseWith(text, format_.decimal_comma);
    if (!value) refuse(row, column, inQuotes(text) + " is not a finite number");
    values.push_back(*value);
  }
  return values;
}

std::vector<std::int64_t> TextTable::integers(int column, std::int64_t minimum, std::int64_t maximum) const {
  std::vector<std::int64_t> values;
  values.reserve(rows_.size());
  for (int row = 0; row < rows(); ++row) {
    const Text text = field(row, column);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < minimum || value > maximum) {
      refuse(
          row, column,
          inQuotes(text) + " is not a whole number from " + std::to_string(minimum) + " to " + std::to_string(maximum));
    }
    values.push_back(value);
  }
  return values;
}

void TextTable::refuse(int row, int column, const std::string& sentence) const {
  const std::string name =
      names_.empty() ? std::to_string(column + 1) : inQuotes(names_[static_cast<std::size_t>(column)]);
  throw InputError(path_ + ":" + std::to_string(line(row)) + ": column " + name + ": " + sentence);
}

}  // namespace knee_robot::recording
