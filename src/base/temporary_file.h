#pragma once

#include <string>

#include "knee_robot/base/errors.h"

namespace knee_robot {

/// "PATH: cannot ACTION: " and the reason in errno.
InputError systemError(const std::string& action, const std::string& path);

/// Closed when it goes.
struct Descriptor {
  int fd;
  ~Descriptor();
};

/// A new file beside `path`, with the rights that the process gives new files; -1: errno says why not.
int createBeside(const std::string& path, std::string& temporary);

/// Writes `content` to a new file beside `path`, and to the disk. Its name; InputError naming `path` when it cannot be
/// written, and nothing is left.
std::string writeBeside(const std::string& path, const std::string& content);

/// New names in the folder of `path` are on the disk when this returns. Throws InputError naming `path`.
void syncFolderOf(const std::string& path);

/// Removes temporary files beside `path` of processes that are no more.
void removeLeftBeside(const std::string& path);

}  // namespace knee_robot
