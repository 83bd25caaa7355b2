#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "knee_robot/simulation/robot_simulation.h"

namespace knee_robot::simulation {

/// The last rows of a simulated robot in POSIX shared memory, every step, for those who judge a controller from
/// outside: a ring of `capacity` rows after a head of magic, row size, capacity and number of rows written so far (8
/// bytes each). Writing is real-time safe; a reader copies the ring and drops the oldest rows, which may have been
/// overwritten meanwhile.
class TruthLog {
 public:
  /// Begin of the shared memory; rows follow.
  struct Head {
    std::uint64_t magic;
    std::uint64_t row_bytes;
    std::uint64_t capacity;
    std::atomic<std::uint64_t> written;
  };
  static constexpr std::uint64_t kMagic = 0x6b6e65655f747274;  // "knee_trt"

  /// Creates or replaces `name` ("/knee_robot_sim_truth"); removed with this. Throws InputError when the system
  /// refuses.
  TruthLog(const std::string& name, std::uint64_t capacity);
  ~TruthLog();
  TruthLog(const TruthLog&) = delete;
  TruthLog& operator=(const TruthLog&) = delete;

  void append(const RobotSimulation& simulation, double monotonic_s) noexcept;

 private:
  const std::string name_;
  std::size_t bytes_ = 0;
  Head* head_ = nullptr;
  TruthRow* rows_ = nullptr;
};

}  // namespace knee_robot::simulation
