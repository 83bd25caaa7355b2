#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace knee_robot {

/// Folders in which the shared files of catkin package `package` may be, best first, existing or not: KNEE_ROBOT_PATH
/// (of this package), the package's sources around `beside`, ROS_PACKAGE_PATH with the sources that lie in it.
std::vector<std::filesystem::path> packageFolders(const std::string& package, const std::filesystem::path& beside);

/// A shared file of this package, "pages/page.html": looked for in share/knee_robot of the space (devel or install)
/// that the running program lies in, then where packageFolders says. Empty when it is nowhere.
std::filesystem::path sharedFile(const std::string& name);

}  // namespace knee_robot
