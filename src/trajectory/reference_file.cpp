#include "knee_robot/trajectory/reference_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <string_view>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"

namespace knee_robot::trajectory {
namespace {

constexpr std::size_t kQuoted = 24;  ///< characters of a bad word that a message repeats

std::string lowered(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// The same but for one letter that is wrong, too many or missing.
bool nearly(std::string_view word, std::string_view right) {
  std::size_t same = 0;
  while (same < std::min(word.size(), right.size()) && word[same] == right[same])
    ++same;
  const std::string_view a = word.substr(same), b = right.substr(same);
  return word == right || (!a.empty() && a.substr(1) == b) || (!b.empty() && b.substr(1) == a) ||
         (!a.empty() && !b.empty() && a.substr(1) == b.substr(1));
}

/// Takes a reference file line by line; its state is what the header has said so far and the points so far.
class ReferenceParser {
 public:
  ReferenceParser(const std::string& name, std::optional<Space> space) : name_(name), asked_(space) {}

  void takeLine(std::string_view line) {
    ++line_;
    line = trimmed(line);
    if (line.empty()) {
      empty_line_ = empty_line_ == 0 ? line_ : empty_line_;
    } else if (line.front() == '#') {
      if (!values_.empty()) refuse("a comment stands after the first point; move it to the top of the file");
      takeHeader(trimmed(line.substr(1)));
    } else {
      takePoint(line);
    }
  }

  Reference finish() const {
    if (values_.empty()) {
      throw InputError(name_ + ":" + std::to_string(std::max(line_, 1)) +
                       ": holds no point; a reference needs at least one line of four numbers");
    }
    if (asked_ && declared_ && *asked_ != *declared_) {
      throw InputError(name_ + ":" + std::to_string(declared_line_) + ": the header says space: " + nameOf(*declared_) +
                       ", but " + nameOf(*asked_) + " was asked for; drop --space or correct the header");
    }
    Reference reference;
    reference.name = name_;
    reference.space = asked_.value_or(declared_.value_or(Space::Actuator));
    reference.period_s = period_s_.value_or(kStreamPeriod);
    reference.first_line = first_line_;
    reference.notes = notes_;
    reference.points = Eigen::Map<const Points>(values_.data(), static_cast<Eigen::Index>(values_.size() / 4), 4);
    return reference;
  }

 private:
  [[noreturn]] void refuse(const std::string& sentence) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + sentence);
  }

  void takeHeader(std::string_view text) {
    const std::size_t colon = text.find(':');
    const std::string key = colon == std::string_view::npos ? "" : lowered(trimmed(text.substr(0, colon)));
    if (key != "space" && key != "period_s") {
      noteMistyped(text);
      return;
    }
    const std::string_view value = trimmed(text.substr(colon + 1));
    if (key == "space") {
      if (declared_) refuse("space is declared twice; keep one");
      declared_ = spaceNamed(lowered(value));
      declared_line_ = line_;
      if (!declared_) refuse("space " + inQuotes(value, kQuoted) + " is unknown; write actuator, platform or relative");
    } else {
      if (period_s_) refuse("period_s is declared twice; keep one");
      period_s_ = parseFinite(value);
      if (!period_s_ || *period_s_ < 1e-4 || *period_s_ > 10.0) {
        refuse("period_s " + inQuotes(value, kQuoted) + " is no number from 0.0001 to 10 s; write period_s: 0.01");
      }
    }
  }

  /// A remark that looks as if it were to declare something: almost one of the keys, then a value of it.
  void noteMistyped(std::string_view text) {
    const std::string low = lowered(text);
    const std::size_t end = std::min(low.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), low.size());
    const std::string key = low.substr(0, end);
    const std::size_t from = std::min(low.find_first_not_of(" \t:=", end), low.size());
    const std::string value = low.substr(from, low.find_first_of(" \t,;", from) - from);
    const bool period = key.rfind("period", 0) == 0 && parseFinite(value);
    if (!period && !(nearly(key, "space") && spaceNamed(value))) return;
    notes_.push_back(name_ + ":" + std::to_string(line_) + ": " + inQuotes(text, kQuoted) +
                     " is read as a remark; if it declares something, write # " +
                     (period ? "period_s: 0.01" : "space: " + value));
  }

  void takePoint(std::string_view line) {
    if (empty_line_ != 0 && !values_.empty()) {
      line_ = empty_line_;
      refuse("an empty line stands between points; remove it, or put in the point that is missing");
    }
    std::array<double, 4> point{};
    std::size_t columns = 0;
    while (!line.empty()) {
      const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
      const std::string_view word = line.substr(0, end);
      if (columns == 4) refuse("has a fifth column " + inQuotes(word, kQuoted) + "; a point has four numbers");
      const std::optional<double> value = parseFinite(word);
      if (!value)
        refuse("column " + std::to_string(columns + 1) + " " + inQuotes(word, kQuoted) + " is no finite number");
      point[columns++] = *value;
      line = trimmed(line.substr(end));
    }
    if (columns < 4) refuse("has " + std::to_string(columns) + " of the four numbers that a point needs");
    if (values_.size() >= 4 * static_cast<std::size_t>(kMaxReferencePoints)) {
      refuse("is beyond the limit of " + std::to_string(kMaxReferencePoints) + " points; split the file");
    }
    if (values_.empty()) first_line_ = line_;
    values_.insert(values_.end(), point.begin(), point.end());
    empty_line_ = 0;
  }

  const std::string& name_;
  std::optional<Space> asked_;
  std::optional<Space> declared_;
  std::optional<double> period_s_;
  std::vector<double> values_;
  std::vector<std::string> notes_;
  int line_ = 0;
  int declared_line_ = 0;
  int first_line_ = 1;
  int empty_line_ = 0;  ///< the first of the empty lines just before this one, 0: none
};

}  // namespace

std::optional<Space> spaceNamed(const std::string& name) {
  for (const Space space : {Space::Actuator, Space::Platform, Space::Relative}) {
    if (name == nameOf(space)) return space;
  }
  return std::nullopt;
}

const char* nameOf(Space space) {
  switch (space) {
    case Space::Actuator:
      return "actuator";
    case Space::Platform:
      return "platform";
    case Space::Relative:
      return "relative";
  }
  return "";
}

Reference parseReference(const std::string& text, const std::string& name, std::optional<Space> space) {
  if (text.size() > kMaxReferenceBytes) {
    throw InputError(name + ": has " + std::to_string(text.size()) + " bytes, more than the limit of " +
                     std::to_string(kMaxReferenceBytes) + "; split the file");
  }
  ReferenceParser parser(name, space);
  std::string_view rest = withoutMark(text);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    parser.takeLine(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return parser.finish();
}

Reference readReference(const std::string& path, std::optional<Space> space) {
  return parseReference(readFile(path, kMaxReferenceBytes), path, space);
}

std::string formatReference(const Reference& reference, const std::vector<std::string>& comments) {
  std::string text =
      "# space: " + std::string(nameOf(reference.space)) + "\n# period_s: " + shortNumber(reference.period_s, 9) + "\n";
  for (const std::string& comment : comments)
    text += "# " + comment + "\n";
  char line[1400];  // four of the longest doubles
  for (Eigen::Index k = 0; k < reference.points.rows(); ++k) {
    const auto point = reference.points.row(k);
    const int length =
        std::snprintf(line, sizeof line, "%.12f %.12f %.12f %.12f\n", point[0], point[1], point[2], point[3]);
    text.append(line, static_cast<std::size_t>(std::min<int>(length, sizeof line - 1)));
  }
  return text;
}

void writeReference(const std::string& path, const Reference& reference, const std::vector<std::string>& comments) {
  writeFileAtomically(path, formatReference(reference, comments));
}

}  // namespace knee_robot::trajectory
