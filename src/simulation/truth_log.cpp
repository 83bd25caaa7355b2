#include "knee_robot/simulation/truth_log.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"

namespace knee_robot::simulation {

TruthLog::TruthLog(const std::string& name, std::uint64_t capacity)
    : name_(name), bytes_(sizeof(Head) + capacity * sizeof(TruthRow)) {
  ::shm_unlink(name.c_str());
  const int file = ::shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
  if (file < 0) throw InputError("truth log " + name + ": " + whyNoSharedMemory(errno));
  void* memory = MAP_FAILED;
  const int full = ::posix_fallocate(file, 0, static_cast<off_t>(bytes_));
  if (full == 0) memory = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file, 0);
  const std::string why =
      full != 0 ? whyNoSharedMemory(full) : std::string("cannot be mapped: ") + std::strerror(errno);
  ::close(file);
  if (memory == MAP_FAILED) {
    ::shm_unlink(name.c_str());
    throw InputError("truth log " + name + ": " + why);
  }
  head_ = new (memory) Head;
  head_->row_bytes = sizeof(TruthRow);
  head_->capacity = capacity;
  head_->written.store(0);
  head_->magic = kMagic;
  rows_ = reinterpret_cast<TruthRow*>(head_ + 1);
}

TruthLog::~TruthLog() {
  ::munmap(head_, bytes_);
  ::shm_unlink(name_.c_str());
}

void TruthLog::append(const RobotSimulation& simulation, double monotonic_s) noexcept {
  const std::uint64_t number = head_->written.load(std::memory_order_relaxed);
  TruthRow& row = rows_[number % head_->capacity];
  row = simulation.truth();
  row.monotonic_s = monotonic_s;
  head_->written.store(number + 1, std::memory_order_release);
}

}  // namespace knee_robot::simulation
