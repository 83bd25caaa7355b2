#include "knee_robot/base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "knee_robot/base/errors.h"

namespace knee_robot {
namespace {

InputError systemError(const std::string& action, const std::string& path) {
  return InputError(path + ": cannot " + action + ": " + std::strerror(errno));
}

struct Descriptor {
  int fd;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

/// A new file beside `path`, with the rights that the process gives new files; -1: errno says why not.
int createBeside(const std::string& path, std::string& temporary) {
  static std::atomic<unsigned> count{0};
  while (true) {
    temporary = path + "." + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".part";
    const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
}

/// Its descriptor; -1: nobody may read it, or the like.
int openFolderOf(const std::string& path) {
  const std::string parent = std::filesystem::path(path).parent_path().string();
  return ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

}  // namespace

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
  std::string temporary;
  Descriptor file{createBeside(path, temporary)};
  if (file.fd < 0) throw systemError("write", path);
  const auto fail = [&] {
    const InputError error = systemError("write", path);
    ::unlink(temporary.c_str());
    return error;
  };
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t put = ::write(file.fd, content.data() + done, content.size() - done);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) throw fail();
    done += static_cast<std::size_t>(put);
  }
  const Descriptor folder{openFolderOf(path)};
  if (::fsync(file.fd) != 0 || ::rename(temporary.c_str(), path.c_str()) != 0) throw fail();
  // The new name is on the disk when the folder is. EINVAL: this file system has no such thing.
  if (folder.fd >= 0 && ::fsync(folder.fd) != 0 && errno != EINVAL) throw systemError("write", path);
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
