#include "impatient_launch.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

namespace knee_robot::nodes {
namespace {

constexpr double kPatientEnough_s = 3600.0;
constexpr const char* kPatience = "--sigint-timeout";

}  // namespace

bool killsTooSoon(const std::string& command) {
  std::istringstream arguments(command);
  bool launches = false, value_follows = false;
  double patience_s = 0.0;
  for (std::string one; std::getline(arguments, one, '\0');) {
    if (value_follows) patience_s = std::atof(one.c_str());
    value_follows = one == kPatience;
    const std::string with_value = std::string(kPatience) + "=";
    if (one.rfind(with_value, 0) == 0) patience_s = std::atof(one.c_str() + with_value.size());
    launches = launches || one == "roslaunch" || (one.size() > 10 && one.substr(one.size() - 10) == "/roslaunch");
  }
  return launches && patience_s < kPatientEnough_s;
}

std::string commandOfParent() {
  std::ifstream file("/proc/" + std::to_string(::getppid()) + "/cmdline", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace knee_robot::nodes
