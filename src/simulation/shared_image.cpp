#include "knee_robot/simulation/shared_image.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::simulation {
namespace {

static_assert(std::atomic<double>::is_always_lock_free, "the status lies in shared memory");

/// File descriptor closed at the end of the scope; the mapping outlives it.
struct Descriptor {
  int number = -1;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

void checkName(const std::string& name) {
  const bool good = name.size() >= 2 && name.size() <= 200 && name[0] == '/' && name.find('/', 1) == std::string::npos;
  if (!good) {
    throw InputError("shared memory name \"" + name +
                     "\": must be a slash and then up to 199 characters without one, as in " + "/knee_robot_sim");
  }
}

[[noreturn]] void refuseMemory(const std::string& name, const std::string& what) {
  throw InputError("shared memory " + name + ": " + what);
}

RobotImage* mapImage(const std::string& name, int descriptor) {
  void* memory = ::mmap(nullptr, sizeof(RobotImage), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (memory == MAP_FAILED) refuseMemory(name, std::string("cannot be mapped: ") + std::strerror(errno));
  return static_cast<RobotImage*>(memory);
}

bool alive(std::int32_t pid) {
  return pid > 0 && (::kill(pid, 0) == 0 || errno == EPERM);
}

/// Removes `name` when its creator is dead or it is no robot image; refuses when the creator lives.
void removeLeftover(const std::string& name) {
  Descriptor leftover{::shm_open(name.c_str(), O_RDWR, 0)};
  struct stat information {};
  if (leftover.number >= 0 && ::fstat(leftover.number, &information) == 0 &&
      static_cast<std::size_t>(information.st_size) >= sizeof(RobotImage)) {
    RobotImage* image = mapImage(name, leftover.number);
    const std::int32_t pid = image->magic.load() == RobotImage::kMagic ? image->plant_pid.load() : 0;
    ::munmap(image, sizeof(RobotImage));
    if (alive(pid)) {
      refuseMemory(name, "process " + std::to_string(pid) +
                             " already simulates a robot under this name; end it or choose another name");
    }
  }
  ::shm_unlink(name.c_str());
}

}  // namespace

SharedImage SharedImage::create(const std::string& name) {
  checkName(name);
  Descriptor memory{::shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600)};
  if (memory.number < 0 && errno == EEXIST) {
    removeLeftover(name);
    memory.number = ::shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
  }
  if (memory.number < 0) refuseMemory(name, whyNoSharedMemory(errno));
  if (const int reason = ::posix_fallocate(memory.number, 0, sizeof(RobotImage)); reason != 0) {
    ::shm_unlink(name.c_str());
    refuseMemory(name, whyNoSharedMemory(reason));
  }
  auto* image = new (mapImage(name, memory.number)) RobotImage;
  image->size = sizeof(RobotImage);
  image->plant_pid.store(::getpid());
  image->magic.store(RobotImage::kMagic, std::memory_order_release);
  return SharedImage(name, image, true);
}

SharedImage SharedImage::attach(const std::string& name) {
  checkName(name);
  const Descriptor memory{::shm_open(name.c_str(), O_RDWR, 0)};
  if (memory.number < 0) {
    refuseMemory(name, errno == ENOENT
                           ? "no simulated robot runs under this name; start one (simulated_robot --shm " + name + ")"
                           : whyNoSharedMemory(errno));
  }
  struct stat information {};
  if (::fstat(memory.number, &information) != 0) refuseMemory(name, std::strerror(errno));
  if (information.st_size == 0) refuseMemory(name, "the simulated robot is just starting; try again");
  if (static_cast<std::size_t>(information.st_size) != sizeof(RobotImage)) {
    refuseMemory(name, "holds " + std::to_string(information.st_size) + " bytes instead of " +
                           std::to_string(sizeof(RobotImage)) + ": no simulated robot, or one of another build");
  }
  RobotImage* image = mapImage(name, memory.number);
  SharedImage attached(name, image, false);
  const std::uint64_t magic = image->magic.load(std::memory_order_acquire);
  if (magic == 0) refuseMemory(name, "the simulated robot is just starting; try again");
  if (magic != RobotImage::kMagic) refuseMemory(name, "holds something else than a simulated robot");
  if (image->version != RobotImage::kVersion || image->size != sizeof(RobotImage)) {
    refuseMemory(name, "the simulated robot has version " + std::to_string(image->version) +
                           " of the image, this program " + std::to_string(RobotImage::kVersion) +
                           ": build both from one source");
  }
  return attached;
}

SharedImage::SharedImage(SharedImage&& other) noexcept
    : name_(std::move(other.name_)),
      image_(std::exchange(other.image_, nullptr)),
      owner_(std::exchange(other.owner_, false)) {}

SharedImage::~SharedImage() {
  if (owner_) ::shm_unlink(name_.c_str());
  if (image_ != nullptr) ::munmap(image_, sizeof(RobotImage));
}

}  // namespace knee_robot::simulation
