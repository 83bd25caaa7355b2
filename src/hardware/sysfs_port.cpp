#include "sysfs_port.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "knee_robot/base/errors.h"

namespace knee_robot::hardware {
namespace {

namespace fs = std::filesystem;

std::string hexadecimal(unsigned value) {
  char text[16];
  std::snprintf(text, sizeof text, "%04x", value);
  return text;
}

/// Number in a one-line sysfs file such as "0x13fe"; -1 when it cannot be read.
long numberIn(const fs::path& file) {
  std::ifstream stream(file);
  std::string text;
  if (!(stream >> text)) return -1;
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 16);
  return end != text.c_str() && *end == '\0' ? value : -1;
}

std::vector<std::string> candidates(const CardQuery& query) {
  std::vector<std::string> folders;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(query.devices, error)) {
    if (numberIn(entry.path() / "vendor") == query.vendor && numberIn(entry.path() / "device") == query.device) {
      folders.push_back(entry.path().string());
    }
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

/// Board id of an open card, -1 when nobody answers.
int boardId(SysfsPort& port, const CardQuery& query) {
  std::uint32_t value = 0;
  std::uint8_t byte = 0;
  IoStatus status = IoStatus::Ok;
  if (query.board_id_is_32_bits) {
    status = port.read32(query.board_id_offset, value);
  } else {
    status = port.read8(query.board_id_offset, byte);
    value = byte;
  }
  return status == IoStatus::Ok ? static_cast<int>(value & 0x0F) : -1;
}

template <typename T>
IoStatus readPort(int descriptor, std::uint32_t offset, T& value) noexcept {
  T fresh{};
  const ssize_t count = ::pread(descriptor, &fresh, sizeof fresh, static_cast<off_t>(offset));
  if (count != static_cast<ssize_t>(sizeof fresh)) return IoStatus::Disconnected;
  value = fresh;
  return IoStatus::Ok;
}

template <typename T>
IoStatus writePort(int descriptor, std::uint32_t offset, T value) noexcept {
  const ssize_t count = ::pwrite(descriptor, &value, sizeof value, static_cast<off_t>(offset));
  return count == static_cast<ssize_t>(sizeof value) ? IoStatus::Ok : IoStatus::Disconnected;
}

/// Written by root only, and every writing counts: one that udev's rule has enabled is left as it is.
void enable(const std::string& path) {
  int enabled = 0;
  if (std::ifstream(path) >> enabled && enabled > 0) return;
  std::ofstream file(path);
  file << "1" << std::flush;
  if (!file)
    throw InputError(path + ": the card is not enabled, and this user may not enable it; run " +
                     "scripts/set_up_industrial_pc, whose udev rule does so at every start, or run as root");
}

}  // namespace

std::unique_ptr<SysfsPort> SysfsPort::find(const CardQuery& query) {
  const std::string kind = hexadecimal(query.vendor) + ":" + hexadecimal(query.device);
  const std::vector<std::string> folders = candidates(query);
  if (folders.empty())
    throw InputError("no PCI card " + kind + " in " + query.devices + ": is it seated, does lspci show it?");
  if (!query.board_id && folders.size() > 1) {
    throw InputError(std::to_string(folders.size()) + " PCI cards " + kind + ": say which by its board id");
  }
  std::string seen;
  for (const std::string& folder : folders) {
    auto port = std::make_unique<SysfsPort>(folder);
    const int id = boardId(*port, query);
    if (!query.board_id || id == *query.board_id) return port;
    seen += (seen.empty() ? "" : ", ") + std::to_string(id);
  }
  throw InputError("no PCI card " + kind + " with board id " + std::to_string(*query.board_id) + " (found: " + seen +
                   "): check the switch on the card");
}

SysfsPort::SysfsPort(const std::string& device_folder) : folder_(device_folder) {
  std::error_code error;
  const fs::path driver = fs::read_symlink(fs::path(device_folder) / "driver", error);
  if (!error) {
    throw InputError(device_folder + ": the kernel driver " + driver.filename().string() +
                     " has claimed this card; blacklist it in /etc/modprobe.d and restart");
  }
  enable(device_folder + "/enable");
  const std::string resource = device_folder + "/resource2";
  descriptor_ = ::open(resource.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor_ < 0) {
    throw InputError(resource + ": " + std::strerror(errno) +
                     "; run scripts/set_up_industrial_pc, or as root, and switch off Secure Boot or kernel lockdown, "
                     "which block port access");
  }
}

SysfsPort::~SysfsPort() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

IoStatus SysfsPort::read8(std::uint32_t offset, std::uint8_t& value) noexcept {
  return readPort(descriptor_, offset, value);
}
IoStatus SysfsPort::read32(std::uint32_t offset, std::uint32_t& value) noexcept {
  return readPort(descriptor_, offset, value);
}
IoStatus SysfsPort::write8(std::uint32_t offset, std::uint8_t value) noexcept {
  return writePort(descriptor_, offset, value);
}
IoStatus SysfsPort::write32(std::uint32_t offset, std::uint32_t value) noexcept {
  return writePort(descriptor_, offset, value);
}

}  // namespace knee_robot::hardware
