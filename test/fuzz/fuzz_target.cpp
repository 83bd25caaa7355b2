// libFuzzer target for one parser of parsers.h, named by the macro KNEE_FUZZ_PARSER. Built by scripts/fuzz with clang.
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "test/fuzz/parsers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const knee_robot::fuzz::Parser& parser = []() -> const knee_robot::fuzz::Parser& {
    for (const auto& one : knee_robot::fuzz::parsers()) {
      if (std::strcmp(one.name, KNEE_FUZZ_PARSER) == 0) return one;
    }
    std::fprintf(stderr, "there is no parser " KNEE_FUZZ_PARSER "\n");
    std::abort();
  }();
  knee_robot::fuzz::feed(parser, std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
