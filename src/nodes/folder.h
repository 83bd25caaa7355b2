#pragma once

#include <string>

namespace knee_robot::nodes {

/// A folder that services may read from or write into, and nothing beside it. Names come from the network: they are
/// resolved, links included, and refused (InputError, one sentence) when what they lead to lies elsewhere.
class Folder {
 public:
  /// Makes the folder unless it exists.
  explicit Folder(const std::string& path);

  /// Absolute path of an existing regular file in the folder or below it; `name` may be absolute or relative to the
  /// folder.
  std::string existingFile(const std::string& name) const;
  /// Absolute path for a new file directly in the folder: a plain name of letters, digits, `.`, `_` and `-` that does
  /// not exist.
  std::string newFile(const std::string& name) const;
  const std::string& path() const { return path_; }

 private:
  std::string path_;  // resolved
};

}  // namespace knee_robot::nodes
