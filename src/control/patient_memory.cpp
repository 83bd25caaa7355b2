#include "knee_robot/control/patient_memory.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::control {
namespace {

constexpr std::size_t kLongest = 4096;

/// Changes when the content does (FNV-1a).
std::string markOf(const std::string& path) {
  std::uint64_t mark = 14695981039346656037ull;
  for (const unsigned char c : readFile(path))
    mark = (mark ^ c) * 1099511628211ull;
  return std::to_string(mark);
}

}  // namespace

const char* toString(Occupancy occupancy) noexcept {
  switch (occupancy) {
    case Occupancy::Unknown:
      return "unknown";
    case Occupancy::Patient:
      return "patient";
    case Occupancy::Empty:
      return "empty";
  }
  return "?";
}

void PatientMemory::remember(const std::string& patient_file) const {
  if (path_.empty()) return;
  makeFolder(path_.substr(0, path_.find_last_of('/')));
  writeFileAtomically(path_, std::filesystem::absolute(patient_file).string() + "\n" + markOf(patient_file) + "\n");
}

void PatientMemory::forget() const {
  if (path_.empty() || ::unlink(path_.c_str()) == 0 || errno == ENOENT) return;
  throw InputError(path_ + ": cannot be removed: " + std::strerror(errno));
}

std::string PatientMemory::remembered() const {
  if (path_.empty() || ::access(path_.c_str(), F_OK) != 0) return "";
  const std::string text = readFile(path_, kLongest);
  const std::size_t end = text.find('\n');
  const std::string file = text.substr(0, end);
  const std::string mark = end == std::string::npos ? "" : text.substr(end + 1, text.find('\n', end + 1) - end - 1);
  if (mark != markOf(file)) throw InputError(file + " is not what it was when the patient was loaded: load it again");
  return file;
}

}  // namespace knee_robot::control
