#pragma once

#include <stdlib.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace knee_robot {

/// An empty folder with a name of its own, which goes with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    if (::mkdtemp(path_.data()) == nullptr) throw std::runtime_error("there is no place for a temporary folder");
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  operator const std::string&() const { return path_; }
  friend std::string operator+(const TemporaryFolder& folder, const std::string& name) { return folder.path_ + name; }
  friend std::filesystem::path operator/(const TemporaryFolder& folder, const std::string& name) {
    return std::filesystem::path(folder.path_) / name;
  }

 private:
  std::string path_ = (std::filesystem::temp_directory_path() / "knee_test_XXXXXX").string();
};

}  // namespace knee_robot
