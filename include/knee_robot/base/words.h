#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace knee_robot {

/// Without blanks, tabs and carriage returns at both ends.
std::string_view trimmed(std::string_view text) noexcept;

/// Without the byte order mark that some programs write at the beginning of a file.
std::string_view withoutMark(std::string_view text) noexcept;

/// A word of a file for a message: in quotes, printable, at most so many characters of it.
std::string inQuotes(std::string_view word, std::size_t most = 40);

/// For a terminal: control characters, which would clear it, colour it or begin lines of their own, and bytes that are no
/// UTF-8 become visible ("\n", "\x1b"). Letters of every language stay.
std::string printable(std::string_view text);

/// "a, b, c": what `text` says of each.
template <typename Range, typename Text>
std::string joined(const Range& range, const Text& text) {
  std::string list;
  for (const auto& one : range)
    list += (list.empty() ? "" : ", ") + text(one);
  return list;
}
/// The same of strings.
template <typename Range>
std::string joined(const Range& range) {
  return joined(range, [](const std::string& word) { return word; });
}

/// "nan" in any case.
bool isNan(std::string_view text) noexcept;

}  // namespace knee_robot
