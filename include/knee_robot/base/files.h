#pragma once

#include <cstddef>
#include <string>

namespace knee_robot {

/// Whole content of a regular file. Throws InputError naming the path when it cannot be read, is not a regular file, or
/// is larger than `max_bytes`.
std::string readFile(const std::string& path, std::size_t max_bytes = 1u << 30);

/// Writes `content` to a temporary file beside `path`, then renames it: a reader sees the old file or the whole new
/// one, never a part, and so does one after a power cut; the new one is on the disk when this returns. Throws
/// InputError naming the path and the system's reason.
void writeFileAtomically(const std::string& path, const std::string& content);

/// Why shared memory cannot be had, from what posix_fallocate answered, and what to do about it. Unlike ftruncate that
/// one finds a full /dev/shm now, and not by a signal when the memory is first touched.
std::string whyNoSharedMemory(int reason);

/// Makes `path` a folder (with its parents) unless it is one. Throws InputError naming the path and the reason.
void makeFolder(const std::string& path);

/// 64-bit FNV-1a of `content` as 16 hex digits: tells whether a file is the one that a model was made with. No
/// protection against intent.
std::string fingerprint(const std::string& content);

}  // namespace knee_robot
