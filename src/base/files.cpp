#include "knee_robot/base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "knee_robot/base/errors.h"
#include "temporary_file.h"

namespace knee_robot {

std::string readFile(const std::string& path, std::size_t max_bytes) {
  // O_NONBLOCK: opening a FIFO must not wait for its writer; it is refused below as not a regular file.
  Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (file.fd < 0) throw systemError("open", path);
  struct stat status {};
  if (::fstat(file.fd, &status) != 0) throw systemError("stat", path);
  if (!S_ISREG(status.st_mode)) throw InputError(path + ": is not a regular file");
  if (static_cast<std::size_t>(status.st_size) > max_bytes) {
    throw InputError(path + ": has " + std::to_string(status.st_size) + " bytes, more than the limit of " +
                     std::to_string(max_bytes));
  }
  std::string content(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t have = 0;
  while (have < content.size()) {
    const ssize_t got = ::read(file.fd, content.data() + have, content.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw systemError("read", path);
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  content.resize(have);
  return content;
}

void writeFileAtomically(const std::string& path, const std::string& content) {
  const std::string temporary = writeBeside(path, content);
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const InputError error = systemError("write", path);
    ::unlink(temporary.c_str());
    throw error;
  }
  syncFolderOf(path);
}

std::string whyNoSharedMemory(int reason) {
  if (reason == EEXIST || reason == EACCES || reason == EPERM)
    return "belongs to another user, who has it open or left it behind; end what that user runs, remove it from "
           "/dev/shm as that user or as root, or choose another name";
  if (reason != ENOSPC) return std::string("cannot be opened or sized: ") + std::strerror(reason);
  return "there is no room left in /dev/shm (df /dev/shm); remove what nobody uses there, or give it more (mount -o "
         "remount,size=64M /dev/shm), then start again";
}

void makeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path)) {
    throw InputError(path + ": cannot make this folder: " + (error ? error.message() : "a file is in its place"));
  }
}

std::string fingerprint(const std::string& content) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const unsigned char byte : content)
    hash = (hash ^ byte) * 0x100000001b3u;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace knee_robot
