#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "black_box.h"

namespace knee_robot::control {

/// Writes what a BlackBox has kept, outside the real-time threads: FOLDER/fault_DATE_TIME_FAULT.csv, a recording like
/// any other (with more columns, which its readers pass over), and beside it the same name with .yaml: fault, sentence,
/// axis, time. Whole files or none. A disk that refuses is reported by error(), and tried again with the next fault.
/// They come without being asked for and nobody may ever remove them: the last room on a disk is left to what has to be
/// written there (who is on the robot, heat, events).
class BlackBoxWriter {
 public:
  static constexpr std::uintmax_t kLeaves = 64u << 20;  ///< bytes

  /// `threaded`: with an own thread; otherwise write() has to be called. An empty folder: nothing is written.
  BlackBoxWriter(BlackBox& box, std::string folder, bool threaded, std::uintmax_t leaves = kLeaves);
  /// Writes what still waits.
  ~BlackBoxWriter();

  /// Writes what waits now.
  void write();
  /// Path of the newest CSV; empty: none yet.
  std::string newest() const;
  /// The disk's refusal, and how many faults came while two still waited for it; empty: all is well.
  std::string error() const;

 private:
  void loop();

  BlackBox& box_;
  const std::string folder_;
  const std::uintmax_t leaves_;
  mutable std::mutex mutex_;
  std::string newest_, error_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// The dump as CSV text.
std::string formatBlackBox(const BlackBoxDump& dump);

}  // namespace knee_robot::control
