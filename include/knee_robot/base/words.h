#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace knee_robot {

/// Without blanks, tabs and carriage returns at both ends.
std::string_view trimmed(std::string_view text) noexcept;

/// A word of a file for a message: in quotes, printable, at most so many characters of it.
std::string inQuotes(std::string_view word, std::size_t most = 40);

/// "nan" in any case.
bool isNan(std::string_view text) noexcept;

}  // namespace knee_robot
