#pragma once

#include <string>
#include <vector>

#include "knee_robot/recording/import.h"

namespace knee_robot::recording {

/// A header line.
inline std::string headerLine(const std::vector<std::string>& names) {
  std::string line;
  for (const std::string& name : names)
    line += (line.empty() ? "" : ",") + name;
  return line + "\n";
}

/// InputError unless the recordings' reader accepts the content.
void requireRecording(const Imported& imported, const std::string& source);

}  // namespace knee_robot::recording
