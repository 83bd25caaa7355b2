#include "controller_action.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "controller_events.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "played_goal.h"
#include "terminal.h"

namespace knee_robot::nodes {
namespace {

constexpr double kSlowestPercent = 5.0;
constexpr double kOnItsWay_s = 0.5;  // a younger goal counts as sent now: clocks of two computers differ a little
constexpr double kOldest_s = 10.0;   // or as far ahead: clocks that differ, a bag of a computer whose clock was ahead

const char* const kPausedSince = "somebody has paused the robot since this goal was sent; nothing moved for it";

bool isMoving(control::MachineState state) {
  return state != control::MachineState::Disabled && state != control::MachineState::Holding &&
         state != control::MachineState::Faulted;
}

PlayResult resultOf(const std::string& sentence) {
  PlayResult result;
  result.message = sentence;
  return result;
}

/// All that a goal says. An id that actionlib had to give says nothing.
std::string wordsOf(const PlayGoal& goal, const std::string& id) {
  std::ostringstream words;
  words << goal << (callerOfGoal(id) == ros::this_node::getName() ? "" : id);
  return words.str();
}

}  // namespace

PlayActionServer::PlayActionServer(ros::NodeHandle& node, control::ControlSystem& system, References& references,
                                   const Folder& recordings, EventLog& log)
    : system_(system),
      references_(references),
      recordings_(recordings),
      log_(log),
      server_(
          node, "play", [this](Handle handle) { receive(handle); }, [this](Handle handle) { cancel(handle); }, false) {
  checker_ = std::thread([this] { checkArrivals(); });
  worker_ = std::thread([this] { work(); });
  server_.start();
}

PlayActionServer::~PlayActionServer() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    interruption_ = Interruption::ShutDown;
  }
  arrived_.notify_all();
  checker_.join();
  worker_.join();
}

control::Answer PlayActionServer::checkMachine(const PlayGoal& goal) const {
  const control::ControlStatus status = system_.status();
  if (status.state == control::MachineState::Faulted) return {false, "the robot is faulted: " + status.fault_sentence};
  if (status.state == control::MachineState::Disabled && !goal.enable)
    return {false, "the robot is disabled; enable it first, or say enable in the goal"};
  if (isMoving(status.state))
    return {false,
            std::string("the robot is ") + control::toString(status.state) + " for somebody else; stop that first"};
  return {true, ""};
}

control::Answer PlayActionServer::checkRepeated(const PlayGoal& goal, const Job& job) {
  const control::ControlStatus status = system_.status();
  // A fault ends in a safe stop, unless the drives were off.
  const std::uint64_t stops = job.stops + status.safe_stops + (status.state == control::MachineState::Faulted ? 1 : 0);
  const std::string why =
      repeated_.whyNot(wordsOf(goal, job.handle.getGoalID().id), stops, ros::SteadyTime::now().toSec());
  return {why.empty(), why};
}

control::Answer PlayActionServer::check(const PlayGoal& goal, Job& job) const {
  // A bag that is played beside the robot says again what was asked for when it was recorded, and a network that was
  // away hands over what nobody waits for any more.
  if (std::abs(job.age_s) > kOldest_s)
    return {false, "the goal was sent " + shortNumber(std::abs(job.age_s), 3) +
                       (job.age_s > 0.0 ? " s ago" : " s ahead of now") +
                       " by its stamp (is a bag being played, was the network away, do the clocks of the two "
                       "computers differ?); send it anew"};
  if (job.age_s > std::max(job.calm_s, kOnItsWay_s))
    return {false, "the goal was sent " + shortNumber(job.age_s, 3) +
                       " s ago by its stamp, and the robot has been stopped or paused, or somebody else put on it, " +
                       shortNumber(job.calm_s, 3) + " s ago; send it anew"};
  // Written so that not-a-number is refused.
  if (!(goal.speed_percent == 0.0 || (goal.speed_percent >= kSlowestPercent && goal.speed_percent <= 100.0)))
    return {false, "speed_percent must lie between 5 and 100, or be 0 for 100, not " + shortNumber(goal.speed_percent)};
  if (!(goal.approach_speed == 0.0 || (goal.approach_speed >= 0.001 && goal.approach_speed <= 0.05)))
    return {false,
            "approach_speed must lie between 0.001 and 0.05 m/s, or be 0, not " + shortNumber(goal.approach_speed)};
  if (goal.file.empty()) {
    if (system_.status().reference.empty())
      return {false, "no file was named and no reference is loaded; name or load one"};
  } else {
    job.checked = references_.check(goal.file, goal.space);
    if (!job.checked.playable) return job.checked.answer;
  }
  if (!goal.record) return {true, ""};
  try {
    job.recording = recordings_.newFile(goal.recording.empty() ? nameAfterTheTime() : goal.recording);
  } catch (const std::exception& error) {  // InputError, a file system that fails, no memory
    return {false, error.what()};
  }
  return {true, ""};
}

void PlayActionServer::note(const std::string& kind, const Handle& handle, const std::string& sentence) {
  const PlayGoal& goal = *handle.getGoal();
  std::string what = "play " + (goal.file.empty() ? "the loaded reference" : goal.file);
  if (goal.enable) what += ", enable";
  if (goal.approach) what += ", approach";
  if (goal.record) what += ", record " + goal.recording;
  log_.add(kind, callerOfGoal(handle.getGoalID().id), what, sentence);
}

/// Called with actionlib's lock held: nothing here may take long, and what is sent to handles must not happen under
/// mutex_, which the worker takes too.
void PlayActionServer::receive(Handle handle) {
  bool ended = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended = ended_;
    if (!ended) {
      Job& job = unchecked_.emplace_back();
      job.handle = handle;
      job.wishes = system_.wishesSoFar();
      job.stops = job.wishes.halts + cancels_;
      job.age_s = ros::Time::now().toSec() - handle.getGoalID().stamp.toSec();
      job.calm_s = job.wishes.last == 0 ? job.age_s : rt::toSeconds(rt::monotonicNow() - job.wishes.last);
    }
  }
  if (ended) handle.setRejected(resultOf("the controller is ending"), "the controller is ending");
  arrived_.notify_all();
}

void PlayActionServer::checkArrivals() {
  while (true) {
    Job job;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      arrived_.wait(lock, [this] { return !unchecked_.empty() || ended_; });
      if (unchecked_.empty()) return;
      job.handle = unchecked_.front().handle;
      job.wishes = unchecked_.front().wishes;
      job.stops = unchecked_.front().stops;
      job.age_s = unchecked_.front().age_s;
      job.calm_s = unchecked_.front().calm_s;
    }
    const PlayGoal& goal = *job.handle.getGoal();
    control::Answer answer = checkRepeated(goal, job);
    if (answer.ok) answer = check(goal, job);
    decide(job, answer);
    std::optional<Job> done;  // goes without the lock: handles take actionlib's lock, which is held where goals arrive
    const std::lock_guard<std::mutex> lock(mutex_);
    done.emplace(std::move(unchecked_.front()));
    unchecked_.pop_front();
  }
}

/// The goal stays in unchecked_ meanwhile: a cancel that comes at any moment finds it there or in next_.
void PlayActionServer::decide(Job& job, control::Answer answer) {
  Handle handle = job.handle;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (unchecked_.front().cancelled) return;
    if (ended_) answer = {false, "the controller is ending"};
    if (answer.ok && !running_) answer = checkMachine(*handle.getGoal());
    // Whoever has paused the other goal meanwhile does not expect that this one moves.
    if (answer.ok && system_.wishesSoFar().pauses != job.wishes.pauses) answer = {false, kPausedSince};
  }
  if (!answer.ok) {
    showAnswer("play", answer);
    note("refused", handle, answer.sentence);
    handle.setRejected(resultOf(answer.sentence), answer.sentence);
    return;
  }
  note("request", handle, "accepted");
  handle.setAccepted("accepted");
  std::optional<Handle> replaced;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (unchecked_.front().cancelled) return;
    if (next_) replaced = next_->handle;
    if (running_) interruption_ = Interruption::Preempted;
    next_ = std::move(job);
    unchecked_.front().cancelled = true;  // from here on next_ is what a cancel finds
  }
  const char* const sentence = "preempted by a newer goal before it began; nothing moved for it";
  if (replaced) replaced->setCanceled(resultOf(sentence), sentence);
  arrived_.notify_all();
}

/// Called with actionlib's lock held.
void PlayActionServer::cancel(Handle handle) {
  std::optional<Job> waiting;
  bool unchecked = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++cancels_;
    for (Job& job : unchecked_) {
      if (!(job.handle == handle) || job.cancelled) continue;
      job.cancelled = unchecked = true;
    }
    if (next_ && next_->handle == handle) {
      waiting.swap(next_);
    } else if (running_ && *running_ == handle && interruption_ == Interruption::None) {
      interruption_ = Interruption::Cancelled;
    }
  }
  const char* const sentence = "cancelled before it began; nothing moved for it";
  if (unchecked) handle.setCanceled(resultOf(sentence), sentence);
  if (waiting) waiting->handle.setCanceled(resultOf(sentence), sentence);
}

void PlayActionServer::work() {
  while (true) {
    Job job;
    std::optional<Handle> done;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      done.swap(running_);
    }
    done.reset();  // without the lock: handles take actionlib's lock, which is held where goals arrive
    {
      std::unique_lock<std::mutex> lock(mutex_);
      arrived_.wait(lock, [this] { return next_ || ended_; });
      if (ended_) break;
      job = std::move(*next_);
      next_.reset();
      running_ = job.handle;
      interruption_ = Interruption::None;
    }
    PlayedGoal(*this, job).run();
  }
  std::optional<Job> left;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    left.swap(next_);
  }
  if (left) left->handle.setAborted(resultOf("the controller is ending"), "the controller is ending");
}

}  // namespace knee_robot::nodes
