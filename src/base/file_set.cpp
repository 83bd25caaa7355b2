#include "knee_robot/base/file_set.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <map>

#include "temporary_file.h"

namespace knee_robot {

FileSet::~FileSet() {
  for (const Staged& one : staged_)
    ::unlink(one.temporary.c_str());
}

void FileSet::add(const std::string& path, const std::string& content) {
  std::error_code unknown;
  if (std::filesystem::is_directory(std::filesystem::symlink_status(path, unknown))) {
    errno = EISDIR;  // found out when it gets its name, the files before it would have theirs
    throw systemError("write", path);
  }
  staged_.push_back({writeBeside(path, content), path});
}

void FileSet::commit() {
  std::map<std::string, std::string> folders;  // and a file of each
  while (!staged_.empty()) {
    const Staged one = staged_.front();
    if (::rename(one.temporary.c_str(), one.path.c_str()) != 0) throw systemError("write", one.path);
    staged_.erase(staged_.begin());
    removeLeftBeside(one.path);
    folders.emplace(std::filesystem::path(one.path).parent_path().string(), one.path);
  }
  for (const auto& [folder, file] : folders)
    syncFolderOf(file);
}

}  // namespace knee_robot
