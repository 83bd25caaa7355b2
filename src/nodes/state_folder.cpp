#include "state_folder.h"

#include <unistd.h>

#include "knee_robot/base/files.h"

namespace knee_robot::nodes {

std::string keptIn(const std::string& state, const std::string& black_box, const std::string& name) {
  const std::string path = state + "/" + name, before = black_box + "/" + name;
  const bool is_there = ::access(path.c_str(), F_OK) == 0, was_there = ::access(before.c_str(), F_OK) == 0;
  if (state == black_box || is_there || !was_there) return path;
  makeFolder(state);
  writeFileAtomically(path, readFile(before));
  ::unlink(before.c_str());  // where it stays, the other one counts
  return path;
}

}  // namespace knee_robot::nodes
