#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "knee_robot/control/recorder.h"
#include "knee_robot/recording/recording_writer.h"

namespace knee_robot::control {

/// What became of a recording.
struct RecordingResult {
  std::string path;           ///< empty: there was none
  std::uint64_t rows = 0;     ///< written
  std::uint64_t dropped = 0;  ///< missing in the file though measured
  std::uint64_t skipped = 0;  ///< cycles that the machine left out: never measured; visible as gaps of time_s
  std::string error;          ///< the disk's refusal; empty: none
};

/// Other side of the recording, outside the real-time path: empties the Recorder's ring into a file, with a thread of its own or,
/// in stepped execution, when asked. Whole lines reach the file at least every 0.2 s. Missing rows are found by their sequence
/// numbers.
class RecordingDrain {
 public:
  /// `threaded`: with an own thread while a recording runs.
  RecordingDrain(Recorder& recorder, int axes, bool threaded);
  ~RecordingDrain();

  /// Throws InputError when the file exists, cannot be made, or a recording runs already.
  void start(const std::string& path);
  /// Writes what is left, forces it to disk, closes. Harmless without recording.
  RecordingResult stop();
  /// Empties the ring now. Stepped execution only.
  void drain();
  /// Of the running recording, or empty.
  RecordingResult progress() const;
  bool isRecording() const;

 private:
  void drainLocked();
  void take(const TrackingRow& row);
  void loop();

  Recorder& recorder_;
  const int axes_;
  const bool threaded_;
  mutable std::mutex mutex_;
  std::unique_ptr<recording::RecordingWriter> writer_;
  RecordingResult result_;
  std::uint32_t number_ = 0;
  std::uint64_t last_sequence_ = 0;
  std::int64_t last_cycle_ = 0;
  std::uint64_t dropped_before_ = 0;
  std::thread thread_;
  std::atomic<bool> stop_{false};
};

}  // namespace knee_robot::control
