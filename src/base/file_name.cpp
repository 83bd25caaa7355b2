#include "knee_robot/base/file_name.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace knee_robot {
namespace {

bool leadsTo(const std::string& path, const struct stat& wanted) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return false;
  return found.st_dev == wanted.st_dev && found.st_ino == wanted.st_ino;
}

}  // namespace

FileNameNow fileNameNow(int file, const std::string& path) {
  struct stat open {};
  if (::fstat(file, &open) != 0 || leadsTo(path, open)) return {};
  const bool named = ::access(path.c_str(), F_OK) == 0;
  if (!named && errno != ENOENT && errno != ENOTDIR) return {};  // a folder that we may not look into any more
  if (open.st_nlink == 0) return {named ? "was replaced by another file" : "was removed", false};
  std::array<char, 4096> now{};
  const ssize_t size = ::readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), now.data(), now.size());
  const std::string moved(now.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  return {leadsTo(moved, open) ? "was moved to " + moved : "was moved", true};
}

}  // namespace knee_robot
