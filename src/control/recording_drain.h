#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "knee_robot/recording/recording_writer.h"
#include "recorder.h"

namespace knee_robot::control {

/// What became of a recording.
struct RecordingResult {
  std::string path;           ///< empty: there was none
  std::uint64_t rows = 0;     ///< written
  std::uint64_t dropped = 0;  ///< missing in the file though measured
  std::uint64_t skipped = 0;  ///< cycles that the machine left out: never measured; visible as gaps of time_s
  std::string error;          ///< the disk's refusal, or what others did to the file; empty: none
};

/// Other side of the recording, outside the real-time path: empties the Recorder's ring into a file, with a thread of
/// its own or, in stepped execution, when asked. Whole lines reach the file at least every 0.2 s. Missing rows are
/// found by their sequence numbers.
///
/// Any number of threads may call: one of several that stop at once gets the recording's result, the others that there
/// is none.
/// No call waits for the disk without end: progress() never does, and a disk that has not answered for kPatience is
/// given up together with the thread that waits for it, which touches nothing but its own file when it comes back.
class RecordingDrain {
 public:
  static constexpr std::chrono::seconds kPatience{3};

  /// `threaded`: with an own thread while a recording runs. `first_home_id`: of the rows before the axes are homed, and
  /// one more with every homing; 0: rows have no home_id.
  RecordingDrain(Recorder& recorder, int axes, bool threaded, std::int64_t first_home_id = 0);
  ~RecordingDrain();

  /// Throws InputError when the file exists, cannot be made, or a recording runs already.
  void start(const std::string& path);
  /// Writes what is left, forces it to disk, closes. Harmless without recording, or without one to the file `only`,
  /// where that is given.
  RecordingResult stop(const std::string& only = "");
  /// Empties the ring now. Stepped execution only.
  void drain();
  /// Of the running recording, or empty.
  RecordingResult progress() const;
  bool isRecording() const { return !progress().path.empty(); }

 private:
  class Job;

  Recorder& recorder_;
  const int axes_;
  const bool threaded_;
  const std::int64_t first_home_id_;
  mutable std::mutex mutex_;  // of the two below; never held while a disk is waited for
  std::shared_ptr<Job> job_;
  bool starting_ = false;
  std::uint32_t number_ = 0;
};

}  // namespace knee_robot::control
