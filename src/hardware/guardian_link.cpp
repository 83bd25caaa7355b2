#include "knee_robot/hardware/guardian_link.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::hardware {
namespace {

static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<std::uint32_t>::is_always_lock_free,
              "the link lies in shared memory");

constexpr char kOther[] =
    "is the link of another version of this package, or no guardian's link; end guardian and controller that use it "
    "with "
    "the drives off (where neither runs, remove it from /dev/shm), then start both, of one version";

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw InputError("guardian's shared memory " + name + ": " + what);
}

}  // namespace

std::uint64_t machineMark(const std::string& machine) noexcept {
  std::uint64_t mark = 14695981039346656037ull;  // FNV-1a
  for (const unsigned char c : machine)
    mark = (mark ^ c) * 1099511628211ull;
  return mark != 0 ? mark : 1;
}

bool letGuardianHandOver(const GuardianLink& link) {
  using std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kLongest(3000);  // a hand-over takes 2.1 s at most
  constexpr std::chrono::milliseconds kGone(2000);     // as long as a guardian waits for brakes that are late
  auto began = steady_clock::now();
  auto heard = began;
  std::int32_t guardian = link.guardian_pid.load();
  std::uint64_t cycles = link.guardian_cycles.load();
  while (link.acts.load() != 0) {
    const auto now = steady_clock::now();
    const std::int32_t latest_guardian = link.guardian_pid.load();
    if (latest_guardian != guardian) began = now;  // a new one has begun the hand-over anew
    guardian = latest_guardian;
    const std::uint64_t latest = link.guardian_cycles.load();
    if (latest != cycles) heard = now;
    cycles = latest;
    if (now - heard > kGone) return true;
    if (now - began > kLongest) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

bool processExists(std::int32_t pid) noexcept {
  return pid > 0 && (::kill(pid, 0) == 0 || errno == EPERM);
}

SharedGuardianLink SharedGuardianLink::open(const std::string& name) {
  if (name.size() < 2 || name.size() > 200 || name[0] != '/' || name.find('/', 1) != std::string::npos) {
    refuse(name, "the name must be a slash and then up to 199 characters without one, as in /knee_robot_guardian");
  }
  const int descriptor = ::shm_open(name.c_str(), O_RDWR | O_CREAT, 0600);
  if (descriptor < 0) refuse(name, whyNoSharedMemory(errno));
  struct stat information {};
  bool fits = ::fstat(descriptor, &information) == 0;
  const bool foreign = information.st_uid != ::geteuid() && information.st_uid != 0;
  if (fits && (foreign || (information.st_mode & (S_IWGRP | S_IWOTH)) != 0)) {
    ::close(descriptor);
    refuse(name,
           "other users may write it, and with it what the drives are given; end who uses it and remove it from "
           "/dev/shm");
  }
  const bool is_new = fits && information.st_size == 0;
  // Two who come at once both set the same size; what is added reads as zero, the link's first state.
  const int full = is_new ? ::posix_fallocate(descriptor, 0, sizeof(GuardianLink)) : 0;
  if (full != 0) {
    ::shm_unlink(name.c_str());
    ::close(descriptor);
    refuse(name, whyNoSharedMemory(full));
  }
  if (!is_new && fits && static_cast<std::size_t>(information.st_size) != sizeof(GuardianLink)) {
    ::close(descriptor);
    refuse(name, kOther);
  }
  void* memory =
      fits ? ::mmap(nullptr, sizeof(GuardianLink), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0) : MAP_FAILED;
  ::close(descriptor);
  if (memory == MAP_FAILED) refuse(name, "cannot be mapped: " + std::string(std::strerror(errno)));
  auto* link = static_cast<GuardianLink*>(memory);
  std::uint64_t found = 0;
  if (!link->magic.compare_exchange_strong(found, GuardianLink::kMagic) && found != GuardianLink::kMagic) {
    ::munmap(memory, sizeof(GuardianLink));
    refuse(name, kOther);
  }
  return SharedGuardianLink(name, link, information.st_ino);
}

SharedGuardianLink::SharedGuardianLink(SharedGuardianLink&& other) noexcept
    : name_(std::move(other.name_)), link_(std::exchange(other.link_, nullptr)), file_(other.file_) {}

bool SharedGuardianLink::isNamed() const noexcept {
  const int descriptor = ::shm_open(name_.c_str(), O_RDONLY, 0);
  if (descriptor < 0) return errno != ENOENT;  // it cannot be looked at: nothing is known against it
  struct stat information {};
  const bool same = ::fstat(descriptor, &information) != 0 || information.st_ino == file_;
  ::close(descriptor);
  return same;
}

SharedGuardianLink::~SharedGuardianLink() {
  if (link_ == nullptr) return;
  for (std::atomic<std::int32_t>* pid : {&link_->controller_pid, &link_->guardian_pid}) {
    std::int32_t mine = ::getpid();
    pid->compare_exchange_strong(mine, 0);
  }
  if (!processExists(link_->controller_pid.load()) && !processExists(link_->guardian_pid.load()) && isNamed()) {
    ::shm_unlink(name_.c_str());
  }
  ::munmap(link_, sizeof(GuardianLink));
}

}  // namespace knee_robot::hardware
