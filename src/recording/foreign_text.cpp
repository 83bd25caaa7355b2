#include "foreign_text.h"

#include <algorithm>
#include <cctype>

namespace knee_robot::recording {
namespace {

using Text = std::string_view;

constexpr int kLinesAbove = 30;  ///< so far down a header is looked for
const char* const kImport =
    "; import_recording FILE -o run.csv --column time_s=time_s --column position_1_m=position_1_m ... makes "
    "a recording of it";

bool has(Text text, Text part) {
  return text.find(part) != Text::npos;
}

/// Looks like the header of a recording, whatever stands between its names.
bool namesColumns(Text line) {
  return has(line, "time_s") && has(line, "position_1_");
}

std::string lowered(Text text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

/// Number of the line that is the header, from 1; 0: none of the first.
int headerLineOf(Text text) {
  for (int number = 1; number <= kLinesAbove && !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (namesColumns(text.substr(0, end))) return number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return 0;
}

}  // namespace

std::string foreignText(Text content) {
  const Text begin = content.substr(0, 200);
  if (content.substr(0, 2) == "\xFF\xFE" || content.substr(0, 2) == "\xFE\xFF" || begin.find('\0') != Text::npos)
    return "the file is no plain text (UTF-16, or binary); save it as UTF-8";
  const Text line = content.substr(0, content.find('\n'));
  const std::size_t cr = line.find('\r');
  if (cr != Text::npos && line.find_first_not_of('\r', cr) != Text::npos)
    return "its lines end in CR alone; write LF or CR LF at their ends (tr '\\r' '\\n' does)";
  if (namesColumns(line)) {
    if (has(line, "\"")) return "its names are in quotes" + std::string(kImport);
    for (const auto& [separator, name] : {std::pair{';', "';'"}, {'\t', "tabs"}, {',', ""}, {' ', "blanks"}}) {
      if (line.find(separator) == Text::npos) continue;
      if (separator == ',') return {};
      return std::string("its columns are separated by ") + name + ", those of a recording by ','" + kImport;
    }
    return {};
  }
  if (namesColumns(lowered(line)))
    return "its names are in another case; write them as time_s, position_1_m, force_1_N" + std::string(kImport);
  if (const int header = headerLineOf(content); header > 1)
    return std::string(line.front() == '#' || line.front() == '%' ? "it begins with a comment"
                                                                  : "its header is not its first line") +
           "; remove what stands above line " + std::to_string(header);
  return {};
}

}  // namespace knee_robot::recording
