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

/// A restart with the same patient needs no room on a disk that is full.
bool says(const std::string& path, const std::string& text) {
  try {
    return readFile(path, kLongest) == text;
  } catch (const InputError&) {
    return false;
  }
}

/// A link on the way that leads nowhere: the disk behind it may not be mounted, and what is not found there was not
/// forgotten.
void refuseBrokenLinks(const std::string& path) {
  namespace fs = std::filesystem;
  fs::path way;
  for (const fs::path& step : fs::path(path)) {
    way /= step;
    std::error_code error;
    if (fs::is_symlink(fs::symlink_status(way, error)) && !fs::exists(way, error))
      throw InputError(path + ": the link " + way.string() + " leads nowhere (is a disk not mounted?)");
  }
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

void PatientMemory::remember(const File& patient) const {
  if (path_.empty()) return;
  const std::string text = std::filesystem::absolute(patient.path).string() + "\n" + patient.mark + "\n";
  if (says(path_, text)) return;
  makeFolder(path_.substr(0, path_.find_last_of('/')));
  writeFileAtomically(path_, text);
}

void PatientMemory::forget() const {
  if (path_.empty() || ::unlink(path_.c_str()) == 0 || errno == ENOENT) return;
  throw InputError(path_ + ": cannot be removed: " + std::strerror(errno));
}

bool PatientMemory::isThere() const noexcept {
  return !path_.empty() && ::access(path_.c_str(), F_OK) == 0;
}

PatientMemory::File PatientMemory::remembered() const {
  if (path_.empty()) return {};
  refuseBrokenLinks(path_);
  if (!isThere()) return {};
  const std::string text = readFile(path_, kLongest);
  const std::size_t end = text.find('\n');
  if (end == std::string::npos || end == 0) throw InputError(path_ + ": does not say which patient was loaded last");
  return {text.substr(0, end), text.substr(end + 1, text.find('\n', end + 1) - end - 1)};
}

}  // namespace knee_robot::control
