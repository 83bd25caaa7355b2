#include "recording_drain.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "knee_robot/base/errors.h"

namespace knee_robot::control {
namespace {

constexpr auto kPause = std::chrono::milliseconds(100);  // twice as often as the promised 0.2 s

}  // namespace

/// One recording. The thread that drains holds a share of it, so that both can be left behind together.
class RecordingDrain::Job : public std::enable_shared_from_this<Job> {
 public:
  Job(Recorder& recorder, const std::string& path, int axes, std::uint32_t number, std::int64_t first_home_id)
      : recorder_(recorder),
        writer_(path, axes),
        number_(number),
        first_home_id_(first_home_id),
        dropped_before_(recorder.dropped()) {
    result_.path = path;
    TrackingRow left_over;
    while (recorder_.pop(left_over)) {
    }
    recorder_.record(number_);
  }

  void begin() {
    std::thread([self = shared_from_this()] { self->loop(); }).detach();
  }
  void drain();
  /// Ordinary end, in the calling thread (stepped) or in the job's own, which is waited for.
  RecordingResult end(bool threaded);
  RecordingResult result() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return result_;
  }

 private:
  void loop();
  void finish();
  /// The ring has one reader: from the moment at which this job is abandoned on it is not this one.
  bool next(TrackingRow& row) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return !abandoned_ && recorder_.pop(row);
  }
  void take(const TrackingRow& row);
  template <typename Change>
  void change(Change&& change) {
    const std::lock_guard<std::mutex> lock(mutex_);
    change(result_);
  }
  void fail(const std::string& error) {
    failed_ = true;
    change([&](RecordingResult& result) { result.error = error; });
  }

  Recorder& recorder_;  // not touched any more once abandoned_
  recording::RecordingWriter writer_;
  const std::uint32_t number_;
  const std::int64_t first_home_id_;
  const std::uint64_t dropped_before_;
  std::uint64_t last_sequence_ = 0;
  std::int64_t last_cycle_ = 0;
  bool failed_ = false;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;  // of what follows
  std::condition_variable ended_;
  bool has_ended_ = false, abandoned_ = false;
  RecordingResult result_;
};

RecordingResult RecordingDrain::Job::end(bool threaded) {
  recorder_.record(0);
  stop_ = true;
  if (!threaded) {
    finish();
    return result();
  }
  std::unique_lock<std::mutex> lock(mutex_);
  if (ended_.wait_for(lock, kPatience, [this] { return has_ended_; })) return result_;
  abandoned_ = true;
  result_.error = "the disk has not answered for " + std::to_string(kPatience.count()) + " s and was given up";
  return result_;
}

void RecordingDrain::Job::loop() {
  while (!stop_.load()) {
    drain();
    std::this_thread::sleep_for(kPause);
  }
  finish();
  const std::lock_guard<std::mutex> lock(mutex_);
  has_ended_ = true;
  ended_.notify_all();
}

void RecordingDrain::Job::finish() {
  drain();
  // Rows that found the ring full after the last one that is in the file leave no gap in the sequence.
  change([&](RecordingResult& result) {
    if (!abandoned_) result.dropped = std::max(result.dropped, recorder_.dropped() - dropped_before_);
  });
  try {
    writer_.close();
  } catch (const std::exception& error) {
    if (!failed_) fail(error.what());
  }
}

void RecordingDrain::Job::drain() {
  TrackingRow row;
  while (next(row)) {
    if (row.recording == number_) take(row);
  }
  if (failed_) return;
  try {
    writer_.flush();
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void RecordingDrain::Job::take(const TrackingRow& row) {
  if (last_sequence_ != 0) {
    const std::uint64_t gap = row.sequence - last_sequence_ - 1;
    const std::uint64_t skipped = static_cast<std::uint64_t>(row.cycle - last_cycle_ - 1) - gap;
    change([&](RecordingResult& result) {
      result.dropped += gap;
      result.skipped += skipped;
    });
  }
  last_sequence_ = row.sequence;
  last_cycle_ = row.cycle;
  recording::RecordingRow line;
  line.time_s = row.time_s;
  line.home_id = first_home_id_ > 0 ? first_home_id_ + row.home_number : 0;
  line.test_pulse = row.test_pulse;
  line.residual_N = row.residual_N;
  line.residual_known = row.residual_known;
  line.reference_m = row.reference_m;
  line.position_m = row.position_m;
  line.velocity_m_per_s = row.velocity_m_per_s;
  line.command_V = row.command_V;
  line.force_N = row.force_N;
  try {
    if (!failed_) writer_.write(line);
  } catch (const std::exception& error) {
    fail(error.what());
  }
  change([&](RecordingResult& result) { ++(failed_ ? result.dropped : result.rows); });
}

RecordingDrain::RecordingDrain(Recorder& recorder, int axes, bool threaded, std::int64_t first_home_id)
    : recorder_(recorder), axes_(axes), threaded_(threaded), first_home_id_(first_home_id) {}

RecordingDrain::~RecordingDrain() {
  stop();
}

RecordingResult RecordingDrain::progress() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return job_ ? job_->result() : RecordingResult{};
}

void RecordingDrain::start(const std::string& path) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (job_) throw InputError("a recording is being written to " + job_->result().path + "; stop it first");
    if (starting_) throw InputError("another recording is being begun or ended; try again");
    starting_ = true;
    ++number_;
  }
  std::shared_ptr<Job> job;
  std::string refused;
  try {
    job = std::make_shared<Job>(recorder_, path, axes_, number_, first_home_id_);
    if (threaded_) job->begin();
  } catch (const std::exception& error) {
    refused = error.what();
    job.reset();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  starting_ = false;
  job_ = job;
  if (!job) throw InputError(refused);
}

RecordingResult RecordingDrain::stop(const std::string& only) {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!job_ || (!only.empty() && job_->result().path != only)) return {};
    job.swap(job_);
    starting_ = true;  // the ring has one reader: the next recording begins when this one has let go of it
  }
  const RecordingResult result = job->end(threaded_);
  const std::lock_guard<std::mutex> lock(mutex_);
  starting_ = false;
  return result;
}

void RecordingDrain::drain() {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    job = job_;
  }
  if (job) job->drain();
}

}  // namespace knee_robot::control
