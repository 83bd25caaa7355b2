#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace knee_robot::nodes {

/// An option of a CommandLine, to be described further: .option("--axis", axis, "axis 1 to 4").within(1, 4).required()
class Option {
 public:
  Option() = default;
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& required();
  /// --help shows the value that it has now.
  Option& showDefault();
  /// Both ends allowed; of the option's own type: int, double or std::uint64_t.
  template <class T>
  Option& within(T low, T high);
  Option& oneOf(const std::vector<std::string>& words);
  /// Exactly so many.
  Option& values(int count);
  /// One word may hold several.
  Option& separatedBy(char delimiter);
  /// Refused without the other one.
  Option& needs(const Option& other);

  /// After parse.
  bool given() const;
  /// "--axis"
  std::string name() const;

 private:
  CLI::Option* option_ = nullptr;  ///< the command line's
};

/// What a program understands, in the words of its --help. CLI11 parses it, which only command_line.cpp includes: its
/// header alone costs four seconds of every program's compilation.
class CommandLine {
 public:
  CommandLine(const std::string& description, const std::string& program);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// `names`: "-o,--output", or "FILE" for an argument without dashes. T: std::string, int, double, std::size_t,
  /// std::uint32_t, std::optional<double>, std::vector<std::string>, std::vector<double>. `value` outlives parse.
  /// Numbers are finite: nan and inf are refused.
  template <class T>
  Option option(const std::string& names, T& value, const std::string& help);
  /// One of a few words, in capitals or not, each of which means a value.
  template <class T>
  Option choice(const std::string& names, T& value, const std::string& help,
                const std::vector<std::pair<std::string, T>>& meanings) {
    std::vector<std::string> words;
    for (const auto& meaning : meanings)
      words.push_back(meaning.first);
    return choiceOf(names, help, words, [&value, meanings](std::size_t k) { value = meanings[k].second; });
  }
  /// Sets `value`; "!--no-NAME" clears it.
  Option flag(const std::string& names, bool& value, const std::string& help);
  /// After the options, in --help.
  void footer(const std::string& text);
  /// Others than its own arguments are for the program to judge.
  void allowExtras();
  /// It works until it is told to end: what it prints is not its result, and a terminal that has gone no failure.
  void serves() { serves_ = true; }
  bool isServing() const { return serves_; }

  const std::string& program() const { return program_; }
  /// False, and the exit status, when nothing more is to be done: --help (0). Throws InputError.
  bool parse(int argc, const char* const* argv, int& status);
  std::vector<std::string> extras() const;

 private:
  Option choiceOf(const std::string& names, const std::string& help, const std::vector<std::string>& words,
                  std::function<void(std::size_t)> choose);

  std::string program_;
  std::unique_ptr<CLI::App> app_;
  bool serves_ = false;
};

}  // namespace knee_robot::nodes
