#include "temporary_file.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <vector>

namespace knee_robot {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".part";

std::string folderOf(const std::string& path) {
  const std::string parent = fs::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

/// The process that a temporary file of `target` belongs to, by its name: TARGET.PROCESS-NUMBER.part; 0: it is none.
::pid_t processOf(const std::string& name, const std::string& target) {
  const std::string start = target + ".";
  if (name.rfind(start, 0) != 0) return 0;
  const char* const end = name.data() + name.size();
  ::pid_t process = 0;
  unsigned number = 0;
  const auto [dash, not_process] = std::from_chars(name.data() + start.size(), end, process);
  if (not_process != std::errc() || dash == end || *dash != '-') return 0;
  const auto [rest, not_number] = std::from_chars(dash + 1, end, number);
  return not_number == std::errc() && std::string(rest, end) == kEnding && process > 0 ? process : 0;
}

bool isGone(::pid_t process) {
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

}  // namespace

InputError systemError(const std::string& action, const std::string& path) {
  return InputError(path + ": cannot " + action + ": " + std::strerror(errno));
}

Descriptor::~Descriptor() {
  if (fd >= 0) ::close(fd);
}

int createBeside(const std::string& path, std::string& temporary) {
  static std::atomic<unsigned> count{0};
  while (true) {
    temporary = path + "." + std::to_string(::getpid()) + "-" + std::to_string(count++) + kEnding;
    const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
}

std::string writeBeside(const std::string& path, const std::string& content) {
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
  if (::fsync(file.fd) != 0) throw fail();
  return temporary;
}

void syncFolderOf(const std::string& path) {
  const Descriptor folder{::open(folderOf(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  // One that nobody may read cannot be opened. EINVAL: this file system has no such thing.
  if (folder.fd >= 0 && ::fsync(folder.fd) != 0 && errno != EINVAL) throw systemError("write", path);
}

void removeLeftBeside(const std::string& path) {
  const std::string target = fs::path(path).filename().string();
  std::vector<fs::path> left;
  std::error_code error;
  for (fs::directory_iterator entry(folderOf(path), error), end; !error && entry != end; entry.increment(error)) {
    const ::pid_t process = processOf(entry->path().filename().string(), target);
    if (process != 0 && isGone(process)) left.push_back(entry->path());
  }
  for (const fs::path& one : left)
    fs::remove(one, error);
}

}  // namespace knee_robot
