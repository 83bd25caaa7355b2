#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "event_file.h"
#include "knee_robot/control/control_system.h"

namespace knee_robot::nodes {

/// One entry of the event log; msg/Event.msg says what the words mean.
struct LoggedEvent {
  std::uint32_t number = 0;  ///< from 1
  double time_s = 0.0;       ///< since 1970
  std::string kind, who, what, answer;
};

/// The entry as one line of JSON: line ends and quotes in somebody's words stay within their string.
std::string toLine(const LoggedEvent& event);

/// Who asked for what and what was answered, states, faults: the newest in memory, all of them in a file. Any ordinary
/// thread may add; a thread of its own writes, so nobody waits for the disk. What the disk refuses, or is too slow for,
/// is kept (the newest kWaiting) and written when it takes them again. Refusals, lost entries and a file that others
/// took away are said in the log itself.
class EventLog {
 public:
  static constexpr std::size_t kRemembered = 500, kWaiting = 2000;
  using Listener = std::function<void(const LoggedEvent&)>;

  explicit EventLog(const std::string& path, std::size_t largest = 4'000'000, int kept = 10);
  /// Writes what still waits, if the disk takes it.
  ~EventLog();

  void add(const std::string& kind, const std::string& who, const std::string& what, const std::string& answer = "");
  /// A request and its answer.
  void request(const std::string& who, const std::string& what, const control::Answer& answer) {
    add(answer.ok ? "request" : "refused", who, what, answer.sentence);
  }
  /// Remembered entries with larger numbers.
  std::vector<LoggedEvent> after(std::uint32_t number) const;
  /// Called for every entry from now on, on the thread that adds it; empty: nobody.
  void setListener(Listener listener);
  /// What the disk says, empty: all is well.
  std::string refusal() const;

 private:
  void addLocked(const std::string& kind, const std::string& who, const std::string& what, const std::string& answer);
  void write();
  void lookAfterTheFile(std::unique_lock<std::mutex>& lock);
  bool writeWaiting(std::unique_lock<std::mutex>& lock);
  void announce(std::uint64_t missing);

  EventFile file_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<LoggedEvent> remembered_;
  std::deque<LoggedEvent> waiting_;
  std::uint32_t count_ = 0;
  std::uint64_t dropped_ = 0;
  std::string refusal_;
  Listener listener_;
  bool ended_ = false;
  std::thread writer_;  // last
};

}  // namespace knee_robot::nodes
