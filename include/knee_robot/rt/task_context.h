#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "knee_robot/rt/command_mailbox.h"
#include "knee_robot/rt/cycle.h"

/// Components in the vocabulary of the Orocos Real-Time Toolkit (RTT); none of its code, and three of its faults
/// mended.
///
/// - A *TaskContext* is a component: a name, a life cycle, ports, properties. It never owns a thread.
/// - An *Activity* is the thread (or the virtual clock of a test) that executes components, one after the other, in a
/// fixed
///   order, once a period.
/// - A *port* carries values of one type from one component to another, without locks. Reading answers *NoData* (never
///   written), *OldData* (nothing since the last read) or *NewData*. A *ConnPolicy* says what is kept in between: the
///   newest value (*Data*) or the oldest n (*Buffer*).
/// - A *property* is a named, typed, bounded parameter, set before the component is configured.
/// - An *operation* is something that other threads may call on a component; it says itself what it does and takes.
/// - The *Deployer* reads which components exist, which activity runs them and how their ports are connected.
/// - *Hooks* are what a component's author writes; they are called in the states below and may refuse.
///
///     PreOperational --configure--> Stopped --start--> Running <--error()/recover--> RunTimeError
///                                      ^-----stop------'
///     any hook throws: stopHook (when running) --> Exception --recover--> PreOperational
///     fatal(): stopHook (when running) --> FatalError, for good
///
/// Differences from RTT, on purpose: states are std::atomic instead of volatile; fatal() runs stopHook too; the overrun
/// limit of an activity is on unless switched off.
namespace knee_robot::rt {

enum class TaskState : std::uint8_t {
  PreOperational,  ///< constructed or recovered; waits for configure()
  Stopped,         ///< configured; waits for start()
  Running,         ///< updateHook is called every period
  RunTimeError,    ///< the component declared an error of its own; no hook is called until recover() leads back
  Exception,       ///< a hook threw; stopped; recover() leads to PreOperational
  FatalError,      ///< beyond repair in this process
};

const char* toString(TaskState state) noexcept;

class OperationBase;
class PortBase;
class PropertyBase;

/// Who executes a component. Answers whether a command must be handed over to be executed between two updates.
class Executor {
 public:
  virtual ~Executor() = default;
  /// True when a thread is executing the component and the calling thread is another one.
  virtual bool mustHandOver() const noexcept = 0;
};

/// A component. Public functions are for other threads and for the deployer; hooks are for the author.
///
/// configure(), start(), stop() and recover() may be called from any ordinary thread. While an activity executes the
/// component, they are handed to the activity's thread and executed there between two updates; the caller sleeps until
/// the answer comes, at most `command_timeout` (1 s). They answer false when the state does not allow the
/// command, when the hook refuses (see refusal()) or when the answer does not come in time (then the command is
/// withdrawn).
class TaskContext {
 public:
  explicit TaskContext(std::string name);
  virtual ~TaskContext();
  TaskContext(const TaskContext&) = delete;
  TaskContext& operator=(const TaskContext&) = delete;

  const std::string& name() const { return name_; }
  /// Acquire: what the hooks wrote before the transition is visible.
  TaskState state() const noexcept { return state_.load(std::memory_order_acquire); }
  bool isRunning() const noexcept { return state() == TaskState::Running || state() == TaskState::RunTimeError; }

  bool configure();  ///< PreOperational -> Stopped; also Stopped -> Stopped (configured anew)
  bool start();      ///< Stopped -> Running
  bool stop();       ///< Running, RunTimeError -> Stopped
  bool recover();    ///< RunTimeError -> Running; Exception -> PreOperational

  /// One cycle: executes a command that was handed over, then, when Running, updateHook. Called by the activity only.
  /// Does not allocate, lock or throw as long as the hooks do not.
  void update(const Cycle& cycle) noexcept;

  /// Sentence of the last hook that refused or of the exception that led to Exception. Read it after the command that
  /// failed or after state() answered Exception or FatalError.
  const char* refusal() const noexcept { return refusal_.data(); }

  const std::vector<PortBase*>& ports() const { return ports_; }
  const std::vector<PropertyBase*>& properties() const { return properties_; }
  const std::vector<OperationBase*>& operations() const { return operations_; }
  PortBase* port(const std::string& name) const;            ///< nullptr when there is none
  PropertyBase* property(const std::string& name) const;    ///< nullptr when there is none
  OperationBase* operation(const std::string& name) const;  ///< nullptr when there is none

  /// For ports, properties, operations (in their constructors) and activities.
  void addPort(PortBase& port);
  void addProperty(PropertyBase& property);
  void addOperation(OperationBase& operation);
  void setExecutor(const Executor* executor) noexcept { executor_.store(executor, std::memory_order_release); }

 protected:
  virtual bool configureHook() { return true; }       ///< may allocate; false: stays PreOperational
  virtual bool startHook() { return true; }           ///< real-time; false: stays Stopped
  virtual void updateHook(const Cycle& /*cycle*/) {}  ///< real-time, once a period while Running
  virtual void stopHook() {}                          ///< real-time; leaves the outside world safe

  /// From updateHook: to RunTimeError.
  void error() noexcept;
  /// From any hook or from the activity's thread: to Exception, as if the hook had thrown.
  void exception(const char* sentence) noexcept;
  /// From any hook: stopHook (when running), FatalError.
  void fatal(const char* sentence) noexcept;
  /// For `return refuse("...")` in a hook. Does not allocate; keeps the first 255 characters.
  bool refuse(const char* sentence) noexcept;

 private:
  enum class Hook { None, Configure, Start, Update, Stop };

  bool perform(Command command);
  bool execute(Command command) noexcept;
  bool refuseCommand(const char* sentence) noexcept;
  bool doConfigure() noexcept;
  bool doStart() noexcept;
  bool doStop() noexcept;
  bool doRecover() noexcept;
  void enterException(Hook thrown_by) noexcept;
  void enterFatal(bool run_stop_hook) noexcept;
  template <typename Call>
  bool guarded(Call&& call) noexcept;

  const std::string name_;
  std::atomic<TaskState> state_{TaskState::PreOperational};
  std::atomic<const Executor*> executor_{nullptr};
  CommandMailbox mailbox_;
  std::array<char, 256> refusal_{};
  Hook active_hook_ = Hook::None;
  std::vector<PortBase*> ports_;
  std::vector<PropertyBase*> properties_;
  std::vector<OperationBase*> operations_;
};

}  // namespace knee_robot::rt
