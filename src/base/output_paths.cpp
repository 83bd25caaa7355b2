#include "knee_robot/base/output_paths.h"

#include <unistd.h>

#include <filesystem>

#include "knee_robot/base/errors.h"
#include "temporary_file.h"

namespace knee_robot {
namespace {

namespace fs = std::filesystem;

bool isThere(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(fs::symlink_status(path, unknown));
}

/// Rights alone do not tell: a disk may be mounted read-only, and /proc takes no files even from root.
bool takesFiles(const fs::path& folder) {
  std::string temporary;
  const Descriptor file{createBeside((folder / "new").string(), temporary)};
  if (file.fd >= 0) ::unlink(temporary.c_str());
  return file.fd >= 0;
}

}  // namespace

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code unknown;
  if (fs::equivalent(a, b, unknown)) return true;
  const fs::path one = fs::weakly_canonical(fs::absolute(a), unknown);
  return !one.empty() && one == fs::weakly_canonical(fs::absolute(b), unknown);
}

void requireWritable(const std::string& file) {
  if (file.empty()) throw InputError("the file to write has an empty name; give it one");
  std::error_code unknown;
  if (isThere(file) && !fs::is_regular_file(file, unknown))
    throw InputError(file + ": is no regular file, which this program would put in its place; choose another name");
  std::string temporary;
  const Descriptor probe{createBeside(file, temporary)};
  if (probe.fd < 0) throw systemError("write", file);
  ::unlink(temporary.c_str());
}

void requireNew(const std::string& file) {
  if (isThere(file)) throw InputError(file + ": exists already, and is not overwritten; choose another name");
  requireWritable(file);
}

void requireWritableFolder(const std::string& folder) {
  if (folder.empty()) throw InputError("the folder to write into has an empty name; give it one");
  fs::path there = fs::absolute(folder);
  while (!isThere(there) && there.has_relative_path())
    there = there.parent_path();
  std::error_code unknown;
  if (!fs::is_directory(there, unknown))
    throw InputError(folder + ": cannot make this folder: " + there.string() + " is no folder; choose another one");
  if (!takesFiles(there)) throw systemError("write into this folder", folder);
}

void requireNoneOverwritten(const std::vector<std::string>& read, const std::vector<std::string>& written) {
  for (const std::string& output : written) {
    for (const std::string& input : read) {
      if (!input.empty() && isSameFile(input, output))
        throw InputError(input + ": is read, and " + (input == output ? "" : "(as " + output + ") ") +
                         "would be overwritten by what this program writes; choose another output");
    }
  }
}

}  // namespace knee_robot
