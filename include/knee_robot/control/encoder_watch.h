#pragma once

#include <algorithm>
#include <cstdint>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/encoder_challenge.h"
#include "knee_robot/control/encoder_probe.h"
#include "knee_robot/control/faults.h"
#include "knee_robot/control/standing_axis.h"

namespace knee_robot::control {

/// Tests whether an axis' encoder counts, while its Driver carries it. With a DisturbanceObserver, EncoderProbe tests
/// once after the holding brakes have opened; later EncoderChallenge tests on suspicion: the standing robot is disturbed,
/// or the loop pushes while the encoder stands (StandingAxis); and in turn where nothing counts for long (RestTurn).
/// Without an observer EncoderProbe tests every `probe_s` at rest, and around turning points. Whenever Monitors take the
/// encoder for dead, it is tested before they say so. One a Driver; real-time safe.
class EncoderWatch {
 public:
  /// Of the axis and its Driver's properties.
  struct Settings {
    std::size_t index = 0;  ///< of the axis
    double metres_per_count = 0.0;
    double force_limit_N = 0.0;
    double open_s = 0.0;  ///< from the order to the holding brakes until they are open
    double probe_s = 0.0;
    double probe_share = 0.0;
    double standing_force_N = 0.0;
    double turning_force_N = 0.0;
    bool observed = false;   ///< there is a DisturbanceObserver
    bool monitored = false;  ///< there are Monitors that may ask
  };
  /// What the Driver knows in this cycle.
  struct Input {
    double dt = 0.0;
    bool carries = false;  ///< the Driver carries the axis, whose length is known and read
    std::int64_t counts = 0;
    bool silent = false;  ///< the counts are old
    double position_m = 0.0;
    double reference_m = 0.0;
    bool at_rest = true;    ///< of the reference
    double loop_N = 0.0;    ///< of the loop, without what the feedforward took from it
    bool searches = false;  ///< it looks for its home: standing against a stop is what is wanted
    bool guiding = false;   ///< a hand may guide
    bool guides = false;    ///< HandGuide's force takes the place of the loop
    bool doubted = false;   ///< HandGuide asks for the encoder
    bool monitor_asks = false;
    bool test_pulses = true;  ///< allowed where nothing raises a suspicion
  };
  /// Answer of a cycle.
  struct Output {
    double force_N = 0.0;       ///< to be added to the axis' force
    Fault fault = Fault::None;  ///< EncoderFrozen, or AxisBlocked where the other axes do not feel it
    bool can_be_asked = false;
    bool answered = false;  ///< the encoder has answered a question in this cycle
  };

  Output step(const Input& in, const Disturbance& disturbed, const Settings& settings) noexcept;

 private:
  bool challenge(const Input& in, const Disturbance& disturbed, const Settings& settings,
                 const EncoderProbe::Settings& probing, bool just_opened) noexcept;
  bool standsUnderForce(const Input& in, const Settings& settings) noexcept;
  void raiseDeadOrBlocked(const Input& in, const Disturbance& disturbed, const Settings& settings) noexcept;

  EncoderProbe probe_;
  EncoderChallenge challenge_;
  StandingAxis standing_;
  std::uint32_t suspicion_ = 0, questions_ = 0;  // answered last
  bool stood_at_rest_ = false;
  double asked_s_ = 0.0;     // since it was asked because of that
  double asked_at_N_ = 0.0;  // of StandingAxis::changed_N(), when a moving axis was asked last
  double again_s_ = 0.0;     // until it may be asked again
  double carried_s_ = 0.0;   // since the holding brake was ordered to let go
  /// Counts since then.
  struct Released {
    std::int64_t lowest = 0, highest = 0;
    void begin(std::int64_t counts) noexcept { lowest = highest = counts; }
    void take(std::int64_t counts) noexcept {
      lowest = std::min(lowest, counts);
      highest = std::max(highest, counts);
    }
    /// More than an open input dithers by.
    bool counts() const noexcept { return highest - lowest > StandingAxis::kDither; }
  } released_;
  bool opening_ = false;      // the question that is asked is that of an axis whose brake has just opened
  double guided_away_ = 1.0;  // counts, for the next question while a hand guides
  Output out_;
};

}  // namespace knee_robot::control
