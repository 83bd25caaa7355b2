#pragma once

#include <string>
#include <vector>

namespace knee_robot {

/// Files that belong together, as a model and its report do: none of them is in its place before all of them are on the
/// disk, so that a full one does not leave a part of a new set beside the rest of an old one.
///
///     FileSet files;
///     files.add(folder + "/model.yaml", model);
///     files.add(folder + "/report.json", report);
///     files.commit();
class FileSet {
 public:
  FileSet() = default;
  /// Without commit, what was added goes, and what was there before stays as it was.
  ~FileSet();
  FileSet(const FileSet&) = delete;
  FileSet& operator=(const FileSet&) = delete;

  /// Writes a temporary file beside `path`. Throws InputError naming the path and the system's reason.
  void add(const std::string& path, const std::string& content);
  /// Gives all files their names, in the order of add, and removes what runs that were killed left beside them.
  void commit();

 private:
  struct Staged {
    std::string temporary, path;
  };
  std::vector<Staged> staged_;
};

}  // namespace knee_robot
