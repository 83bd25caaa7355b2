#pragma once

#include <actionlib/server/action_server.h>
#include <knee_robot/PlayAction.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "controller_references.h"
#include "event_log.h"
#include "folder.h"
#include "goal_stamps.h"
#include "knee_robot/control/control_system.h"
#include "repeated_goals.h"

namespace knee_robot::nodes {

/// The action `~play`: see action/Play.action for what it does and its policies. One thread checks the goals in the
/// order in which they arrive (a long file takes its time, and cancelling must not wait for it), another one plays
/// them. The services stay available meanwhile: a pause pauses the goal, a stop or a fault aborts it.
class PlayActionServer {
 public:
  PlayActionServer(ros::NodeHandle& node, control::ControlSystem& system, References& references,
                   const Folder& recordings, EventLog& log);
  /// A goal that is being played is stopped along its path and aborted.
  ~PlayActionServer();

 private:
  using Server = actionlib::ActionServer<PlayAction>;
  using Handle = Server::GoalHandle;
  struct Job {
    Handle handle;
    CheckedReference checked;     // empty: the loaded reference
    std::string recording;        // full path, empty: none
    control::WishesSoFar wishes;  // when it arrived: a stop or a pause after that is for it, too
    std::uint64_t stops = 0;      // halts and cancels until it arrived
    double age_s = 0.0;           // when it arrived, by its stamp
    double calm_s = 0.0;          // then, since the last stop or pause
    bool cancelled = false;       // before it was checked
  };
  enum class Interruption { None, Cancelled, Preempted, ShutDown };

  void receive(Handle handle);
  void cancel(Handle handle);
  void checkArrivals();
  void decide(Job& job, control::Answer answer);
  control::Answer checkRepeated(const PlayGoal& goal, const Job& job);
  control::Answer check(const PlayGoal& goal, Job& job) const;
  control::Answer checkMachine(const PlayGoal& goal) const;
  void work();
  void note(const std::string& kind, const Handle& handle, const std::string& sentence);

  control::ControlSystem& system_;
  References& references_;
  const Folder& recordings_;
  EventLog& log_;
  RepeatedGoals repeated_;  // of the checker alone

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Job> unchecked_;  // the first is being checked
  std::optional<Job> next_;
  std::optional<Handle> running_;
  std::uint64_t cancels_ = 0;
  std::atomic<Interruption> interruption_{Interruption::None};
  bool ended_ = false;
  Server server_;
  std::thread checker_, worker_;

  friend class PlayedGoal;
};

}  // namespace knee_robot::nodes
