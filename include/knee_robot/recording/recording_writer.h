#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace knee_robot::recording {

/// One row of our own recordings; only the first `axes` entries are written.
struct RecordingRow {
  double time_s = 0.0;
  std::int64_t home_id = 0;  ///< changes whenever the axes are homed anew; 0: not known
  int test_pulse = 0;        ///< sum of 2^(i-1) over the axes i whose encoder is being asked whether it counts
  std::array<double, 4> reference_m{};
  std::array<double, 4> position_m{};
  std::array<double, 4> velocity_m_per_s{};
  std::array<double, 4> command_V{};  ///< as written to the DAC, after clamp and quantization
  std::array<double, 4> force_N{};    ///< the force that this command asks for
  std::array<double, 4>
      residual_N{};             ///< force less what the controller's model expects, low-passed (residual_estimator.h)
  bool residual_known = false;  ///< else nan is written, as for a residual that is no number: it never ends a recording
};

/// Streams rows into a recording file (docs/contract.md, section 2). Only whole lines ever reach the file, so that it
/// is readable after a crash; nothing is allocated after opening. Not for a real-time thread: it writes to disk.
class RecordingWriter {
 public:
  /// Creates `path` and writes the header. InputError when the file exists already (a recording is never overwritten)
  /// or cannot be created. `axes` is 1 to 4.
  RecordingWriter(const std::string& path, int axes);
  /// Closes without reporting errors; call close() to hear of them.
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Adds one row to the buffer; writes the buffer out when it is full. InputError with the system's reason when the
  /// disk refuses (full, gone). A value that is not finite, or a time that does not increase, is an InputError too: the
  /// reader would refuse it.
  void write(const RecordingRow& row);
  /// Hands all buffered rows to the operating system.
  void flush();
  /// Flushes, forces the data to disk, closes. Further calls do nothing. InputError, too, when somebody else has removed,
  /// replaced, moved or changed the file meanwhile.
  void close();

  std::size_t rows() const { return rows_; }
  const std::string& path() const { return path_; }

 private:
  void append(const char* text, std::size_t size);
  void appendNumber(double value, int decimals, char separator);
  void takeBackHalfLine(std::size_t done);

  std::string path_;
  int axes_;
  int file_ = -1;
  std::size_t rows_ = 0;
  double last_time_s_;
  std::vector<char> buffer_;
  std::size_t used_ = 0;
  std::int64_t bytes_ = 0;  ///< in the file, whole lines
};

}  // namespace knee_robot::recording
