#pragma once

#include <string>

namespace knee_robot {

/// What has become of the name of a file that is open: writing to one that was removed or renamed goes on without a
/// word.
struct FileNameNow {
  /// "was removed", "was replaced by another file", "was moved to PATH", "was moved"; empty: the name leads to the
  /// file, or the system does not tell.
  std::string lost;
  /// The file itself is there under another name.
  bool kept = true;
};

/// Of the open file `file`, opened as `path`. Asks the disk: not for a real-time thread.
FileNameNow fileNameNow(int file, const std::string& path);

}  // namespace knee_robot
