#pragma once

#include <string>
#include <vector>

namespace knee_robot {

/// What a program is going to write is looked at before its work, which may take minutes. Nothing is made or changed;
/// InputError, one sentence that names the path.

/// The file can be written: what is there now, if anything, is a regular file, and its folder takes new ones.
void requireWritable(const std::string& file);

/// It can, and nothing is there yet.
void requireNew(const std::string& file);

/// The folder, or the one in which it would have to be made, takes new files.
void requireWritableFolder(const std::string& folder);

/// Both lead to one file, or would, through links too.
bool isSameFile(const std::string& a, const std::string& b);

/// None of the files that would be `written` is one of those that are `read`, under whatever name and through links.
void requireNoneOverwritten(const std::vector<std::string>& read, const std::vector<std::string>& written);

}  // namespace knee_robot
