#include "command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "knee_robot/base/errors.h"

namespace knee_robot::nodes {
namespace {

template <class T>
constexpr bool kHoldsDoubles =
    std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>> || std::is_same_v<T, std::vector<double>>;

/// Whatever cannot be read as a number is for the conversion to refuse. CLI::Range lets nan through.
std::string whyNotFinite(const std::string& word) {
  double value = 0.0;
  const bool number = CLI::detail::lexical_cast(word, value);
  return number && !std::isfinite(value) ? word + " is not a finite number" : "";
}

/// std::stoull takes -1 for the largest number that there is.
std::string whyNegative(const std::string& word) {
  return word.rfind('-', 0) == 0 ? word + " is negative; give a whole number from 0" : "";
}

template <class T>
constexpr bool kHoldsWords = std::is_same_v<T, std::string> || std::is_same_v<T, std::vector<std::string>>;

}  // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::showDefault() {
  option_->capture_default_str();
  return *this;
}

template <class T>
Option& Option::within(T low, T high) {
  option_->check(CLI::Range(low, high));
  return *this;
}
template Option& Option::within(int, int);
template Option& Option::within(double, double);
template Option& Option::within(std::uint64_t, std::uint64_t);

Option& Option::oneOf(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words));
  return *this;
}

Option& Option::values(int count) {
  option_->expected(count);
  return *this;
}

Option& Option::separatedBy(char delimiter) {
  option_->delimiter(delimiter);
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

std::string Option::name() const {
  return option_->get_name();
}

bool Option::given() const {
  return option_->count() > 0;
}

CommandLine::CommandLine(const std::string& description, const std::string& program)
    : program_(program), app_(std::make_unique<CLI::App>(description, program)) {}
CommandLine::~CommandLine() = default;

template <class T>
Option CommandLine::option(const std::string& names, T& value, const std::string& help) {
  CLI::Option* const option = app_->add_option(names, value, help);
  if constexpr (kHoldsDoubles<T>) option->check(whyNotFinite, "");
  if constexpr (std::is_same_v<T, std::size_t>) option->check(whyNegative, "");
  if constexpr (kHoldsWords<T>) {
    const auto whyNoWord = [app = app_.get()](const std::string& word) {
      if (word.empty() || word.front() != '-' || app->get_option_no_throw(word) == nullptr) return std::string();
      return "a value is missing: the next option, " + word + ", stands in its place";
    };
    option->check(whyNoWord, "");
  }
  return Option(option);
}
template Option CommandLine::option(const std::string&, std::string&, const std::string&);
template Option CommandLine::option(const std::string&, int&, const std::string&);
template Option CommandLine::option(const std::string&, double&, const std::string&);
template Option CommandLine::option(const std::string&, std::size_t&, const std::string&);
template Option CommandLine::option(const std::string&, std::uint32_t&, const std::string&);
template Option CommandLine::option(const std::string&, std::optional<double>&, const std::string&);
template Option CommandLine::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option CommandLine::option(const std::string&, std::vector<double>&, const std::string&);

Option CommandLine::choiceOf(const std::string& names, const std::string& help, const std::vector<std::string>& words,
                             std::function<void(std::size_t)> choose) {
  const std::function<void(const std::string&)> take = [words, choose](const std::string& word) {
    choose(static_cast<std::size_t>(std::find(words.begin(), words.end(), word) - words.begin()));
  };
  CLI::Option* option = app_->add_option_function(names, take, help);
  return Option(option->transform(CLI::IsMember(words, CLI::ignore_case)));
}

Option CommandLine::flag(const std::string& names, bool& value, const std::string& help) {
  return Option(app_->add_flag(names, value, help));
}

void CommandLine::footer(const std::string& text) {
  app_->footer(text);
}

void CommandLine::allowExtras() {
  app_->allow_extras();
}

bool CommandLine::parse(int argc, const char* const* argv, int& status) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help and the like
    status = app_->exit(request);
    return false;
  } catch (const CLI::ParseError& error) {
    throw InputError(std::string(error.what()) + " (see --help)");
  }
  return true;
}

std::vector<std::string> CommandLine::extras() const {
  return app_->remaining();
}

}  // namespace knee_robot::nodes
