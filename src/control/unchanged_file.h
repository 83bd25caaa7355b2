#pragma once

#include <string>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::control {

/// A file that is read several times: whoever judges it must have read what whoever uses it has read.
class UnchangedFile {
 public:
  /// An empty path is no file. InputError where it cannot be read.
  explicit UnchangedFile(const std::string& path) : path_(path), text_(path.empty() ? "" : readFile(path)) {}
  /// InputError where it is another one now.
  void require() const {
    if (!path_.empty() && readFile(path_) != text_)
      throw InputError(path_ + ": was replaced while the controller started; start it again");
  }

 private:
  const std::string path_, text_;
};

}  // namespace knee_robot::control
