#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <vector>

namespace knee_robot {

constexpr double kAboveZero = 1e-12;  ///< "greater than zero", as a minimum: intervals are closed

/// A YAML map whose every key must be asked for: an unknown key, a duplicate key, a wrong type or a number outside its
/// limits is an InputError that names file, line, key, value and limit. Call finish() when all keys have been asked
/// for.
///
///     StrictMap file = StrictMap::load(path);
///     const double stroke = file.number("stroke_m", 0.0, 1.0);
///     file.finish();
class StrictMap {
 public:
  static StrictMap load(const std::string& path);
  /// `name` stands for the file in messages.
  static StrictMap parse(const std::string& text, const std::string& name);

  bool has(const std::string& key) const;
  std::string text(const std::string& key);
  std::string textOr(const std::string& key, const std::string& fallback);
  /// A finite number in [minimum, maximum].
  double number(const std::string& key, double minimum, double maximum);
  double numberOr(const std::string& key, double fallback, double minimum, double maximum);
  int integer(const std::string& key, int minimum, int maximum);
  int integerOr(const std::string& key, int fallback, int minimum, int maximum);
  bool flagOr(const std::string& key, bool fallback);
  /// A list of exactly `count` finite numbers (any number of them when count is 0), each in [minimum, maximum].
  std::vector<double> numbers(const std::string& key, std::size_t count, double minimum, double maximum);
  std::vector<std::string> texts(const std::string& key);
  /// One of `choices`.
  std::string choice(const std::string& key, const std::vector<std::string>& choices);
  std::string choiceOr(const std::string& key, const std::string& fallback, const std::vector<std::string>& choices);
  StrictMap map(const std::string& key);
  std::optional<StrictMap> mapIfAny(const std::string& key);
  /// A list of maps.
  std::vector<StrictMap> maps(const std::string& key);
  /// All keys of this map, in file order; they count as asked for only when they are then read.
  std::vector<std::string> keys() const;

  /// Refuses keys that nobody asked for.
  void finish() const;
  /// "FILE:LINE: KEY: " for messages about one key.
  std::string where(const std::string& key) const;
  /// Throws InputError(where(key) + sentence).
  [[noreturn]] void refuse(const std::string& key, const std::string& sentence) const;

 private:
  StrictMap(YAML::Node node, std::string file);
  YAML::Node take(const std::string& key);
  double toNumber(const YAML::Node& node, const std::string& key, double minimum, double maximum) const;

  YAML::Node node_;
  std::string file_;
  std::vector<std::string> asked_;
};

}  // namespace knee_robot
