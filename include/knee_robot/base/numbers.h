#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace knee_robot {

/// The finite number that `text` holds, whole and nothing else (no blanks, no trailing characters, decimal point
/// whatever the locale; a leading '+' is accepted). Empty for anything else: words, hex, inf, nan, overflow.
std::optional<double> parseFinite(std::string_view text);

/// `value` as a reader expects it: up to `digits` significant digits, no trailing zeros ("0.6", "1e-06").
std::string shortNumber(double value, int digits = 6);

/// The shortest text that parseFinite turns into exactly `value` again. For files.
std::string exactNumber(double value);

}  // namespace knee_robot
