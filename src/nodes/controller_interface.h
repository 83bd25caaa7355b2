#pragma once

#include <ros/ros.h>

#include <array>
#include <atomic>
#include <memory>

#include "controller_action.h"
#include "controller_components.h"
#include "controller_diagnostics.h"
#include "controller_events.h"
#include "controller_feedforward.h"
#include "controller_gains.h"
#include "controller_ports.h"
#include "controller_references.h"
#include "controller_services.h"
#include "controller_timing.h"
#include "controller_topics.h"
#include "stamped_queue.h"

namespace knee_robot::nodes {

/// Everything of the controller that ROS sees: services, topics, the action, diagnostics, gains. One object so that it
/// can be made anew when the master was restarted. Each group has its own callback queue and threads, so none waits for
/// another:
///
///     commands (3 threads)  what may take seconds: enable, home, load, ...; the components
///     stops (4)             emergency_stop, stop, pause, disable, set_speed, get_state
///     action (2)            goals and cancels of ~play
///     topics (1)            publishing and diagnostics
///     onlookers (1)         the event log and watched ports
class ControllerInterface {
 public:
  struct Parts {
    control::ControlSystem& system;
    const mechanism::Robot& robot;
    References& references;
    const Folder& patients;
    const Folder& recordings;
    double rate_hz;
    const std::atomic<GuardianSupervision::Guardian>& guardian;
    EventLog& log;
  };
  explicit ControllerInterface(const Parts& parts);
  ~ControllerInterface() { references_.withdraw(); }

 private:
  /// A private node handle with a queue that `threads` threads serve from start() on. Its callbacks know
  /// ControlSystem::wishesSoFar() of when they came.
  class Lane {
   public:
    Lane(const control::ControlSystem& system, std::uint32_t threads)
        : queue_([&system] { return system.wishesSoFar(); }), spinner_(threads, &queue_) {
      node.setCallbackQueue(&queue_);
    }
    void start() { spinner_.start(); }
    void stop() { spinner_.stop(); }
    ros::NodeHandle node{"~"};

   private:
    StampedQueue queue_;
    ros::AsyncSpinner spinner_;
  };
  /// Stops the threads before anything that they call is gone.
  struct Running {
    std::array<Lane*, 5> lanes;
    ~Running() {
      for (Lane* lane : lanes)
        lane->stop();
    }
  };

  References& references_;
  Lane commands_, stops_, actions_, topics_lane_, onlookers_;
  PlayActionServer action_;
  ControllerGains gains_;
  ControllerFeedforward feedforward_;
  ControllerTopics topics_;
  ControllerTiming timing_;
  ControllerDiagnostics diagnostics_;
  ControllerComponents components_;
  ControllerEvents events_;
  ControllerPorts ports_;
  ControllerServices services_;
  Running running_;
};

}  // namespace knee_robot::nodes
