#include "knee_robot/base/package_folders.h"

#include <cstdlib>

#include "knee_robot/base/files.h"

namespace knee_robot {
namespace {

namespace fs = std::filesystem;

/// `folder` or the nearest one above it that is the source of catkin package `package`.
fs::path sourceOfPackage(const std::string& package, fs::path folder) {
  for (; !folder.empty(); folder = folder.parent_path()) {
    if (fs::is_regular_file(folder / "package.xml")) {
      const std::string text = readFile((folder / "package.xml").string());
      if (text.find("<name>" + package + "</name>") != std::string::npos) return folder;
    }
    if (folder == folder.parent_path()) break;
  }
  return {};
}

/// The folder of the running program.
fs::path programFolder() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none).parent_path();
}

}  // namespace

std::vector<fs::path> packageFolders(const std::string& package, const fs::path& beside) {
  std::vector<fs::path> folders;
  const char* own = std::getenv("KNEE_ROBOT_PATH");
  if (own != nullptr && *own != '\0' && package == "knee_robot") folders.emplace_back(own);
  const fs::path around = sourceOfPackage(package, fs::absolute(beside).lexically_normal());
  if (!around.empty()) folders.push_back(around);
  const char* variable = std::getenv("ROS_PACKAGE_PATH");
  std::string paths = variable == nullptr ? "" : variable;
  while (!paths.empty()) {
    const std::size_t colon = paths.find(':');
    const fs::path entry = paths.substr(0, colon);
    paths = colon == std::string::npos ? "" : paths.substr(colon + 1);
    if (entry.empty()) continue;
    folders.push_back(entry / package);
    if (!sourceOfPackage(package, entry).empty()) folders.push_back(sourceOfPackage(package, entry));
  }
  return folders;
}

fs::path sharedFile(const std::string& name) {
  const fs::path program = programFolder();
  std::vector<fs::path> folders = {program / "../../share/knee_robot"};  // made together with the program
  for (const fs::path& folder : packageFolders("knee_robot", program))
    folders.push_back(folder);
  for (const fs::path& folder : folders) {
    std::error_code none;
    if (fs::is_regular_file(folder / name, none)) return (folder / name).lexically_normal();
  }
  return {};
}

}  // namespace knee_robot
