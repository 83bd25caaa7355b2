#include "event_log.h"

#include <chrono>
#include <nlohmann/json.hpp>

namespace knee_robot::nodes {
namespace {

constexpr std::size_t kLongestText = 2000;  // of what somebody else may have written
constexpr auto kRetry = std::chrono::seconds(1);
constexpr auto kLook = std::chrono::seconds(1);  // whether the file is still there, when nothing happens

double wallTime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<double>(std::chrono::duration_cast<std::chrono::milliseconds>(now).count()) / 1000.0;
}

}  // namespace

std::string toLine(const LoggedEvent& event) {
  const nlohmann::ordered_json json = {{"number", event.number}, {"time", event.time_s}, {"kind", event.kind},
                                       {"who", event.who},       {"what", event.what},   {"answer", event.answer}};
  return json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
}

EventLog::EventLog(const std::string& path, std::size_t largest, int kept)
    : file_(path, largest, kept), writer_([this] { write(); }) {}

EventLog::~EventLog() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
  }
  arrived_.notify_all();
  writer_.join();
}

void EventLog::addLocked(const std::string& kind, const std::string& who, const std::string& what,
                         const std::string& answer) {
  LoggedEvent event{++count_,
                    wallTime(),
                    kind,
                    who.substr(0, kLongestText),
                    what.substr(0, kLongestText),
                    answer.substr(0, kLongestText)};
  remembered_.push_back(event);
  if (remembered_.size() > kRemembered) remembered_.pop_front();
  if (listener_) listener_(event);
  waiting_.push_back(std::move(event));
  if (waiting_.size() <= kWaiting) return;
  waiting_.pop_front();
  ++dropped_;
}

void EventLog::add(const std::string& kind, const std::string& who, const std::string& what,
                   const std::string& answer) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    addLocked(kind, who, what, answer);
  }
  arrived_.notify_all();
}

std::vector<LoggedEvent> EventLog::after(std::uint32_t number) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<LoggedEvent> events;
  for (const LoggedEvent& event : remembered_) {
    if (event.number > number) events.push_back(event);
  }
  return events;
}

void EventLog::setListener(Listener listener) {
  const std::lock_guard<std::mutex> lock(mutex_);
  listener_ = std::move(listener);
}

std::string EventLog::refusal() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return refusal_;
}

/// Called with the lock held, gives it back while it asks the disk.
void EventLog::lookAfterTheFile(std::unique_lock<std::mutex>& lock) {
  lock.unlock();
  const std::string done = file_.doneByOthers();
  lock.lock();
  if (!done.empty()) addLocked("log", "", file_.path() + ": " + done + " by somebody else; the log goes on here", "");
}

/// Called with the lock held, gives it back while it writes.
bool EventLog::writeWaiting(std::unique_lock<std::mutex>& lock) {
  const std::size_t count = waiting_.size();
  const std::uint64_t dropped = dropped_;
  std::string lines;
  for (const LoggedEvent& event : waiting_)
    lines += toLine(event);
  lock.unlock();
  const std::string reason = file_.append(lines);
  lock.lock();
  if (!reason.empty()) {
    if (refusal_.empty())
      addLocked("log", "", file_.path() + ": " + reason + "; entries wait in memory until the disk takes them", "");
    refusal_ = reason;
    return false;
  }
  // What was dropped from the front meanwhile is written, unless it came after the lines were made.
  const std::uint64_t gone = dropped_ - dropped;
  const std::uint64_t unwritten = gone > count ? gone - count : 0;
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count - (gone - unwritten)));
  announce(dropped + unwritten);
  return true;
}

/// With the lock held: after a refusal, or where entries were lost because the disk was too slow for them.
void EventLog::announce(std::uint64_t missing) {
  const bool again = !refusal_.empty();
  refusal_.clear();
  if (again || missing > 0) {
    if (waiting_.size() >= kWaiting) ++missing;  // this entry takes the place of another one
    addLocked("log", "", file_.path() + (again ? ": written again" : ": the disk was too slow"),
              missing == 0 ? "" : std::to_string(missing) + " entries are missing in it");
  }
  dropped_ = 0;
}

void EventLog::write() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    if (refusal_.empty()) {
      arrived_.wait_for(lock, kLook, [this] { return !waiting_.empty() || ended_; });
    } else {
      arrived_.wait_for(lock, kRetry, [this] { return ended_; });
    }
    lookAfterTheFile(lock);
    while (!waiting_.empty() && writeWaiting(lock)) {
    }
    if (ended_) return;
  }
}

}  // namespace knee_robot::nodes
