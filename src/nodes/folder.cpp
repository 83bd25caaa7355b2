#include "folder.h"

#include <algorithm>
#include <filesystem>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::nodes {
namespace fs = std::filesystem;

Folder::Folder(const std::string& path) {
  makeFolder(path);
  path_ = fs::canonical(path).string();
}

std::string Folder::existingFile(const std::string& name) const {
  if (name.empty()) throw InputError("no file was named; files are looked up in " + path_);
  if (name.size() > 1024 || name.find('\0') != std::string::npos) throw InputError("the file name is not a path");
  std::error_code error;
  const fs::path resolved = fs::canonical(fs::path(path_) / name, error);
  if (error) throw InputError(name + ": " + error.message() + "; files are looked up in " + path_);
  const fs::path folder(path_);
  if (std::mismatch(folder.begin(), folder.end(), resolved.begin(), resolved.end()).first != folder.end()) {
    throw InputError(name + ": lies outside the folder " + path_ + "; copy it there or configure another folder");
  }
  if (!fs::is_regular_file(resolved)) throw InputError(name + ": is not a regular file");
  return resolved.string();
}

std::string Folder::newFile(const std::string& name) const {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '.' || c == '_' || c == '-'; };
  if (name.empty() || name.front() == '.' || name.size() > 200 || !std::all_of(name.begin(), name.end(), plain)) {
    throw InputError("'" + name.substr(0, 80) + "' is no name for a new file: use letters, digits, '.', '_' and '-'");
  }
  const fs::path path = fs::path(path_) / name;
  if (fs::exists(fs::symlink_status(path))) throw InputError(path.string() + ": exists already; choose another name");
  return path.string();
}

}  // namespace knee_robot::nodes
