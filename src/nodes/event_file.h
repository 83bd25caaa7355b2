#pragma once

#include <cstddef>
#include <string>

namespace knee_robot::nodes {

/// A text file that lines are appended to, each whole or not at all, and on the disk when append() returns. Bounded: at
/// `largest` bytes it becomes NAME.1 (and NAME.1 becomes NAME.2, ...); `kept` old ones stay. A file that others remove or
/// rename is made again. One thread.
class EventFile {
 public:
  EventFile(std::string path, std::size_t largest, int kept);
  ~EventFile();
  EventFile(const EventFile&) = delete;
  EventFile& operator=(const EventFile&) = delete;

  /// `lines`: one or more, each with its line end. Empty: they are on the disk. Else the system's reason: none of them
  /// is in the file, and the next call tries again from the opening on.
  std::string append(const std::string& lines);
  /// What others have done to the file since it was written last: "was removed", "was moved to PATH", "was cut short";
  /// empty: nothing. The next append() makes the file again where its name does not lead to it any more.
  std::string doneByOthers();
  const std::string& path() const { return path_; }

 private:
  bool open();
  bool rotate();
  std::string fail(const char* action);

  const std::string path_;
  const std::size_t largest_;
  const int kept_;
  int file_ = -1;
  std::size_t size_ = 0;
};

}  // namespace knee_robot::nodes
