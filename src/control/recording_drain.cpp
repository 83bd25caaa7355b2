#include "knee_robot/control/recording_drain.h"

#include <algorithm>
#include <chrono>

#include "knee_robot/base/errors.h"

namespace knee_robot::control {
namespace {

constexpr auto kPause = std::chrono::milliseconds(100);  // twice as often as the promised 0.2 s

}  // namespace

RecordingDrain::RecordingDrain(Recorder& recorder, int axes, bool threaded)
    : recorder_(recorder), axes_(axes), threaded_(threaded) {}

RecordingDrain::~RecordingDrain() {
  stop();
}

bool RecordingDrain::isRecording() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return writer_ != nullptr;
}

RecordingResult RecordingDrain::progress() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return writer_ != nullptr ? result_ : RecordingResult{};
}

void RecordingDrain::start(const std::string& path) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (writer_ != nullptr) throw InputError("a recording is being written to " + result_.path + "; stop it first");
  writer_ = std::make_unique<recording::RecordingWriter>(path, axes_);
  TrackingRow left_over;
  while (recorder_.pop(left_over)) {
  }
  result_ = RecordingResult{};
  result_.path = path;
  last_sequence_ = 0;
  dropped_before_ = recorder_.dropped();
  stop_ = false;
  recorder_.record(++number_);
  if (threaded_) thread_ = std::thread([this] { loop(); });
}

RecordingResult RecordingDrain::stop() {
  if (!isRecording()) return {};
  recorder_.record(0);
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  const std::lock_guard<std::mutex> lock(mutex_);
  drainLocked();
  // Rows that found the ring full after the last one that is in the file leave no gap in the sequence.
  result_.dropped = std::max(result_.dropped, recorder_.dropped() - dropped_before_);
  try {
    writer_->close();
  } catch (const InputError& error) {
    if (result_.error.empty()) result_.error = error.what();
  }
  writer_.reset();
  return result_;
}

void RecordingDrain::drain() {
  const std::lock_guard<std::mutex> lock(mutex_);
  drainLocked();
}

void RecordingDrain::loop() {
  while (!stop_.load()) {
    drain();
    std::this_thread::sleep_for(kPause);
  }
}

void RecordingDrain::drainLocked() {
  TrackingRow row;
  while (recorder_.pop(row)) {
    if (row.recording == number_ && writer_ != nullptr) take(row);
  }
  if (writer_ == nullptr || !result_.error.empty()) return;
  try {
    writer_->flush();
  } catch (const InputError& error) {
    result_.error = error.what();
  }
}

void RecordingDrain::take(const TrackingRow& row) {
  if (last_sequence_ != 0) {
    const std::uint64_t gap = row.sequence - last_sequence_ - 1;
    result_.dropped += gap;
    result_.skipped += static_cast<std::uint64_t>(row.cycle - last_cycle_ - 1) - gap;
  }
  last_sequence_ = row.sequence;
  last_cycle_ = row.cycle;
  if (!result_.error.empty()) {
    ++result_.dropped;
    return;
  }
  recording::RecordingRow line;
  line.time_s = row.time_s;
  line.reference_m = row.reference_m;
  line.position_m = row.position_m;
  line.velocity_m_per_s = row.velocity_m_per_s;
  line.command_V = row.command_V;
  line.force_N = row.force_N;
  try {
    writer_->write(line);
    ++result_.rows;
  } catch (const InputError& error) {
    result_.error = error.what();
    ++result_.dropped;
  }
}

}  // namespace knee_robot::control
