#include "knee_robot/base/words.h"

namespace knee_robot {

std::string_view trimmed(std::string_view text) noexcept {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && blank(text.back()))
    text.remove_suffix(1);
  return text;
}

std::string inQuotes(std::string_view word, std::size_t most) {
  std::string out = "'";
  for (const char c : word.substr(0, most))
    out += (c >= 32 && c < 127) ? c : '?';
  return out + (word.size() > most ? "...'" : "'");
}

bool isNan(std::string_view text) noexcept {
  return text.size() == 3 && (text[0] | 32) == 'n' && (text[1] | 32) == 'a' && (text[2] | 32) == 'n';
}

}  // namespace knee_robot
