#include "knee_robot/base/strict_yaml.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"

namespace knee_robot {
namespace {

std::string lineOf(const YAML::Node& node) {
  return node.Mark().is_null() ? "" : ":" + std::to_string(node.Mark().line + 1);
}

/// Line of the first content of a second document; 0: there is none. YAML::LoadAll does not end on some broken texts.
int secondDocument(const std::string& text) {
  bool content = false, marked = false;
  int number = 1;
  for (std::size_t at = 0; at < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trimmed(std::string_view(text).substr(at, end - at));
    const bool mark = text.compare(at, 3, "---") == 0 && (line.size() == 3 || line[3] == ' ');
    const bool silent = line.empty() || line.front() == '#' || line.front() == '%' || line == "...";
    if (mark && content) marked = true;
    if (!mark && !silent && marked) return number;
    content = content || (!mark && !silent);
    at = end + 1;
  }
  return 0;
}

}  // namespace

StrictMap::StrictMap(YAML::Node node, std::string file) : node_(std::move(node)), file_(std::move(file)) {
  if (!node_.IsMap()) throw InputError(file_ + lineOf(node_) + ": expected `key: value` pairs here");
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) throw InputError(file_ + lineOf(entry.first) + ": a key must be a plain word");
    if (!seen.insert(entry.first.Scalar()).second) {
      throw InputError(file_ + lineOf(entry.first) + ": " + entry.first.Scalar() + " stands here twice; remove one");
    }
  }
}

StrictMap StrictMap::load(const std::string& path) {
  return parse(readFile(path, 16u << 20), path);
}

StrictMap StrictMap::parse(const std::string& text, const std::string& name) {
  try {
    const YAML::Node first = YAML::Load(text);
    if (const int line = secondDocument(text); line > 0)
      throw InputError(name + ":" + std::to_string(line) +
                       ": a second YAML document begins above this line (---), and "
                       "only one is read; remove one, or the line ---");
    return StrictMap(first, name);
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw InputError(name + line + ": not valid YAML: " + error.msg);
  }
}

bool StrictMap::has(const std::string& key) const {
  return std::any_of(node_.begin(), node_.end(), [&](const auto& entry) { return entry.first.Scalar() == key; });
}

YAML::Node StrictMap::take(const std::string& key) {
  if (!has(key)) throw InputError(file_ + lineOf(node_) + ": the key " + key + " is missing");
  asked_.push_back(key);
  return static_cast<const YAML::Node&>(node_)[key];
}

std::string StrictMap::where(const std::string& key) const {
  const YAML::Node value = static_cast<const YAML::Node&>(node_)[key];
  return file_ + (value.IsDefined() ? lineOf(value) : lineOf(node_)) + ": " + key + ": ";
}

void StrictMap::refuse(const std::string& key, const std::string& sentence) const {
  throw InputError(where(key) + sentence);
}

std::string StrictMap::text(const std::string& key) {
  const YAML::Node value = take(key);
  if (!value.IsScalar()) refuse(key, "expected one word or text");
  return value.Scalar();
}

std::string StrictMap::textOr(const std::string& key, const std::string& fallback) {
  return has(key) ? text(key) : fallback;
}

double StrictMap::toNumber(const YAML::Node& node, const std::string& key, double minimum, double maximum) const {
  const std::optional<double> value = node.IsScalar() ? parseFinite(node.Scalar()) : std::nullopt;
  if (!value)
    refuse(key, "expected a finite number" + (node.IsScalar() ? ", not '" + node.Scalar() + "'" : std::string()));
  if (*value < minimum || *value > maximum) {
    refuse(key, shortNumber(*value) + " is outside " + shortNumber(minimum) + " .. " + shortNumber(maximum));
  }
  return *value;
}

double StrictMap::number(const std::string& key, double minimum, double maximum) {
  return toNumber(take(key), key, minimum, maximum);
}

double StrictMap::numberOr(const std::string& key, double fallback, double minimum, double maximum) {
  return has(key) ? number(key, minimum, maximum) : fallback;
}

int StrictMap::integer(const std::string& key, int minimum, int maximum) {
  const double value = number(key, minimum, maximum);
  if (value != std::floor(value)) refuse(key, "expected a whole number, not " + shortNumber(value));
  return static_cast<int>(value);
}

int StrictMap::integerOr(const std::string& key, int fallback, int minimum, int maximum) {
  return has(key) ? integer(key, minimum, maximum) : fallback;
}

bool StrictMap::flagOr(const std::string& key, bool fallback) {
  if (!has(key)) return fallback;
  return choice(key, {"true", "false"}) == "true";
}

std::vector<double> StrictMap::numbers(const std::string& key, std::size_t count, double minimum, double maximum) {
  const YAML::Node value = take(key);
  if (!value.IsSequence() || (count != 0 && value.size() != count)) {
    refuse(key, "expected a list of " + (count == 0 ? std::string() : std::to_string(count) + " ") + "numbers");
  }
  std::vector<double> all;
  for (const auto& entry : value)
    all.push_back(toNumber(entry, key, minimum, maximum));
  return all;
}

std::vector<std::string> StrictMap::texts(const std::string& key) {
  const YAML::Node value = take(key);
  if (!value.IsSequence()) refuse(key, "expected a list");
  std::vector<std::string> all;
  for (const auto& entry : value) {
    if (!entry.IsScalar()) refuse(key, "expected a list of plain words");
    all.push_back(entry.Scalar());
  }
  return all;
}

std::string StrictMap::choice(const std::string& key, const std::vector<std::string>& choices) {
  const std::string value = text(key);
  if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
    refuse(key, "'" + value + "' is not one of " + joined(choices));
  }
  return value;
}

std::string StrictMap::choiceOr(const std::string& key, const std::string& fallback,
                                const std::vector<std::string>& choices) {
  return has(key) ? choice(key, choices) : fallback;
}

StrictMap StrictMap::map(const std::string& key) {
  const YAML::Node value = take(key);
  if (!value.IsMap()) refuse(key, "expected `key: value` pairs");
  return StrictMap(value, file_);
}

std::optional<StrictMap> StrictMap::mapIfAny(const std::string& key) {
  if (!has(key)) return std::nullopt;
  return map(key);
}

std::vector<StrictMap> StrictMap::maps(const std::string& key) {
  const YAML::Node value = take(key);
  if (!value.IsSequence()) refuse(key, "expected a list");
  std::vector<StrictMap> all;
  for (const auto& entry : value)
    all.push_back(StrictMap(entry, file_));
  return all;
}

std::vector<std::string> StrictMap::keys() const {
  std::vector<std::string> all;
  for (const auto& entry : node_)
    all.push_back(entry.first.Scalar());
  return all;
}

void StrictMap::finish() const {
  for (const auto& entry : node_) {
    const std::string& key = entry.first.Scalar();
    if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) {
      throw InputError(file_ + lineOf(entry.first) + ": unknown key " + key + "; known here: " + joined(asked_));
    }
  }
}

}  // namespace knee_robot
