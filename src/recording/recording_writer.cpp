#include "knee_robot/recording/recording_writer.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/file_name.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::recording {
namespace {

constexpr std::size_t kBufferBytes = 1u << 16;
constexpr std::size_t kLongestRow = 4096;  ///< 27 numbers below 1e15 need a tenth of it
constexpr double kLargest = 1e12;

InputError failure(const std::string& path, const char* action) {
  return InputError(path + ": cannot " + action + " the recording: " + std::strerror(errno));
}

std::string header(int axes) {
  std::string line = "time_s";
  for (int i = 1; i <= axes; ++i) {
    const std::string axis = std::to_string(i);
    line += ",reference_" + axis + "_m,position_" + axis + "_m,velocity_" + axis + "_m_per_s,command_" + axis +
            "_V,force_" + axis + "_N,residual_" + axis + "_N";
  }
  return line + ",home_id,test_pulse\n";
}

/// What others have done to the recording while it was written, so that it is not what its writer believes; empty:
/// nothing.
std::string doneByOthers(int file, const std::string& path, std::int64_t bytes) {
  const std::string again = "; record again, and leave the recording and its folder alone until it has ended";
  const FileNameNow name = fileNameNow(file, path);
  if (!name.kept) return name.lost + " while it was being recorded: its rows are gone" + again;
  if (!name.lost.empty()) return name.lost + " while it was being recorded: its rows are there, not under this name";
  struct stat status {};
  if (::fstat(file, &status) != 0 || status.st_size == bytes) return "";
  return "was changed by somebody else while it was being recorded: it has " + std::to_string(status.st_size) +
         " bytes instead of the recorded " + std::to_string(bytes) + again;
}

}  // namespace

RecordingWriter::RecordingWriter(const std::string& path, int axes)
    : path_(path), axes_(axes), last_time_s_(-std::numeric_limits<double>::infinity()), buffer_(kBufferBytes) {
  if (axes < 1 || axes > 4) throw InputError(path + ": a recording has 1 to 4 axes, not " + std::to_string(axes));
  // O_APPEND: in a file that somebody cuts short, later rows follow the earlier ones, not a heap of zeros.
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) throw failure(path, "create");
  const std::string line = header(axes);
  append(line.data(), line.size());
  try {
    flush();
  } catch (...) {
    ::close(file_);
    throw;
  }
}

RecordingWriter::~RecordingWriter() {
  try {
    close();
  } catch (const InputError&) {  // a destructor has nobody to tell; close() is the way to hear of it
  }
}

void RecordingWriter::append(const char* text, std::size_t size) {
  std::memcpy(buffer_.data() + used_, text, size);
  used_ += size;
}

void RecordingWriter::appendNumber(double value, int decimals, char separator) {
  // to_chars: no allocation, and a decimal point whatever the locale.
  char* const begin = buffer_.data() + used_;
  const auto result = std::to_chars(begin, begin + 64, value, std::chars_format::fixed, decimals);
  used_ += static_cast<std::size_t>(result.ptr - begin);
  buffer_[used_++] = separator;
}

void RecordingWriter::write(const RecordingRow& row) {
  if (file_ < 0) throw InputError(path_ + ": the recording is closed already");
  bool sane = std::abs(row.time_s) < kLargest;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes_); ++i) {
    for (const double value :
         {row.reference_m[i], row.position_m[i], row.velocity_m_per_s[i], row.command_V[i], row.force_N[i]}) {
      sane = sane && std::abs(value) < kLargest;  // false for nan
    }
  }
  if (!sane) throw InputError(path_ + ": row " + std::to_string(rows_ + 1) + " holds a value that is not finite");
  if (row.time_s <= last_time_s_) {
    throw InputError(path_ + ": row " + std::to_string(rows_ + 1) + " is not later than the one before it (" +
                     shortNumber(row.time_s, 12) + " s)");
  }
  if (used_ + kLongestRow > buffer_.size()) flush();
  appendNumber(row.time_s, 6, ',');
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes_); ++i) {
    appendNumber(row.reference_m[i], 9, ',');
    appendNumber(row.position_m[i], 9, ',');
    appendNumber(row.velocity_m_per_s[i], 9, ',');
    appendNumber(row.command_V[i], 9, ',');
    appendNumber(row.force_N[i], 6, ',');
    const bool sane_residual = row.residual_known && std::abs(row.residual_N[i]) < kLargest;
    appendNumber(sane_residual ? row.residual_N[i] : kNan, 4, ',');
  }
  appendNumber(static_cast<double>(row.home_id), 0, ',');
  appendNumber(row.test_pulse, 0, '\n');
  last_time_s_ = row.time_s;
  ++rows_;
}

void RecordingWriter::flush() {
  std::size_t done = 0;
  while (done < used_) {
    const ssize_t put = ::write(file_, buffer_.data() + done, used_ - done);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      const InputError error = failure(path_, "write");
      takeBackHalfLine(done);
      throw error;
    }
    done += static_cast<std::size_t>(put);
  }
  bytes_ += static_cast<std::int64_t>(done);
  used_ = 0;
}

/// The disk took `done` bytes of the buffer and no more: leaves whole lines in the file, and the rest for a later
/// flush.
void RecordingWriter::takeBackHalfLine(std::size_t done) {
  std::size_t whole = done;
  while (whole > 0 && buffer_[whole - 1] != '\n')
    --whole;
  struct stat status {};
  if (whole < done &&
      (::fstat(file_, &status) != 0 || ::ftruncate(file_, status.st_size - static_cast<off_t>(done - whole)) != 0)) {
    whole = done;  // neither taken back nor written again
  }
  bytes_ += static_cast<std::int64_t>(whole);
  std::memmove(buffer_.data(), buffer_.data() + whole, used_ - whole);
  used_ -= whole;
}

void RecordingWriter::close() {
  if (file_ < 0) return;
  const int file = file_;
  try {
    flush();
  } catch (...) {
    file_ = -1;
    ::close(file);
    throw;
  }
  file_ = -1;
  const bool synced = ::fsync(file) == 0;
  const InputError error = failure(path_, "finish");
  const std::string others = doneByOthers(file, path_, bytes_);
  if (::close(file) != 0 || !synced) throw error;
  if (!others.empty()) throw InputError(path_ + ": " + others);
}

}  // namespace knee_robot::recording
