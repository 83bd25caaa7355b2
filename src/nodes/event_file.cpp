#include "event_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "knee_robot/base/file_name.h"

namespace knee_robot::nodes {
namespace {

bool writeAll(int file, const char* text, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(file, text, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace

EventFile::EventFile(std::string path, std::size_t largest, int kept)
    : path_(std::move(path)), largest_(largest), kept_(kept) {}

EventFile::~EventFile() {
  if (file_ >= 0) ::close(file_);
}

/// Of what a process left that died while it wrote, the last line is ended: ours begins on one of its own.
bool EventFile::open() {
  std::error_code ignored;  // the opening says it
  std::filesystem::create_directories(std::filesystem::path(path_).parent_path(), ignored);
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0640);
  if (file_ < 0) return false;
  struct stat status {};
  if (::fstat(file_, &status) != 0) return false;
  size_ = static_cast<std::size_t>(status.st_size);
  char last = '\n';
  if (size_ > 0 && ::pread(file_, &last, 1, status.st_size - 1) == 1 && last != '\n') {
    if (!writeAll(file_, "\n", 1)) return false;
    ++size_;
  }
  return true;
}

bool EventFile::rotate() {
  ::close(file_);
  file_ = -1;
  for (int i = kept_; i > 0; --i) {
    const std::string from = i > 1 ? path_ + "." + std::to_string(i - 1) : path_;
    if (std::rename(from.c_str(), (path_ + "." + std::to_string(i)).c_str()) != 0 && errno != ENOENT) return false;
  }
  return open();
}

std::string EventFile::fail(const char* action) {
  const std::string reason = std::string("cannot ") + action + ": " + std::strerror(errno);
  if (file_ >= 0) ::close(file_);
  file_ = -1;
  return reason;
}

std::string EventFile::doneByOthers() {
  if (file_ < 0) return "";
  const std::string lost = fileNameNow(file_, path_).lost;
  if (!lost.empty()) {
    ::close(file_);
    file_ = -1;
    return lost;
  }
  struct stat status {};
  if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) return "";
  const std::size_t before = size_;
  size_ = static_cast<std::size_t>(status.st_size);
  return size_ < before ? "was cut short" : "";
}

std::string EventFile::append(const std::string& lines) {
  if (file_ < 0 && !open()) return fail("open");
  if (size_ > 0 && size_ + lines.size() > largest_ && !rotate()) return fail("rotate");
  if (!writeAll(file_, lines.data(), lines.size())) {
    const int cause = errno;
    if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) errno = cause;  // a device; the next opening ends the line
    errno = cause;
    return fail("write");
  }
  size_ += lines.size();
  if (::fdatasync(file_) != 0 && errno != EINVAL && errno != EROFS) return fail("flush");
  return "";
}

}  // namespace knee_robot::nodes
