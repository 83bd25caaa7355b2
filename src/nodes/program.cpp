#include "program.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>

#include "knee_robot/base/errors.h"

namespace knee_robot::nodes {
namespace {

/// Line breaks would make two lines of one sentence.
std::string oneLine(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r'))
    text.pop_back();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

int fail(const CommandLine& app, const std::string& sentence, int status) {
  std::cout.flush();
  std::cerr << app.program() << ": " << oneLine(sentence) << std::endl;
  return status;
}

/// As a shell reads it back.
std::string shellWord(const std::string& word) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || std::strchr("_-./:=,+@%", c) != nullptr; };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string out = "'";
  for (const char c : word)
    out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

}  // namespace

int runProgram(CommandLine& app, int argc, const char* const* argv, const std::function<int()>& body) {
  openStandardStreams();
  try {
    int status = kExitDone;
    if (!app.parse(argc, argv, status)) return status;
    for (const std::string& extra : app.extras()) {
      if (extra.find(":=") == std::string::npos) throw InputError("unknown argument " + extra + " (see --help)");
    }
    const int status_of_body = body();
    if (app.isServing()) return status_of_body;
    const bool lost = !std::cout.flush() | (std::fflush(stdout) != 0) | (std::ferror(stdout) != 0);
    if (lost && status_of_body == kExitDone) return fail(app, "the output could not be written (is the disk full?)", 1);
    return status_of_body;
  } catch (const InputError& error) {
    return fail(app, error.what(), kExitBadInput);
  } catch (const Refusal& error) {
    return fail(app, error.what(), kExitRefused);
  } catch (const std::exception& error) {
    return fail(app, std::string("unexpected failure: ") + error.what(), 1);
  }
}

void openStandardStreams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    if (::open("/dev/null", O_RDWR) != stream) return;  // the lowest number that is free
  }
}

void limitDescriptors() {
  constexpr rlim_t kMost = 4096;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max = std::min(limit.rlim_max, kMost);
  if (::setrlimit(RLIMIT_NOFILE, &limit) != 0) std::perror("the limit of descriptors cannot be set");
}

std::string commandLine(const std::string& program, int argc, const char* const* argv) {
  std::string line = "rosrun knee_robot " + program;
  for (int i = 1; i < argc; ++i)
    line += " " + shellWord(argv[i]);
  return line;
}

}  // namespace knee_robot::nodes
