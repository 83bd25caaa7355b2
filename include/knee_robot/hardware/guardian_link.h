#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "knee_robot/hardware/channels.h"

namespace knee_robot::hardware {

/// What controller and guardian tell each other, in shared memory of its own: it does not depend on whether a card can
/// read back its outputs (the PCI-1720 can not, of the PCI-1784 it is not known). All zero: nobody has been there yet.
/// Each field has one writer; plain lock-free atomics, so a process that dies at any place leaves the others working.
struct GuardianLink {
  static constexpr std::uint64_t kMagic = 0x6b6e65655f677235;  // "knee_gr5"

  std::atomic<std::uint64_t> magic{0};

  // written by the controller
  std::atomic<std::int32_t> controller_pid{0};  ///< 0: none, or it has ended properly
  std::atomic<std::uint64_t> heartbeat{0};      ///< one more with every write of the digital outputs, fenced out or not
  std::atomic<std::uint32_t> armed{0};          ///< 1 from before the drives are enabled until after they are disabled
  std::atomic<std::uint32_t> reset_request{0};  ///< a new number asks the guardian to give the outputs back
  std::atomic<std::uint32_t> carries{0};        ///< 1: load_V is valid; the drives give it until the brakes hold
  std::array<std::atomic<double>, kChannels> load_V{};             ///< what carries the robot at rest at this place
  std::array<std::atomic<std::int32_t>, kChannels> slip_counts{};  ///< BrakeWatch
  std::array<std::atomic<double>, kChannels> counts_per_mm{};      ///< BrakeWatch
  std::atomic<std::int64_t> carried_at_ns{0};                      ///< when load_V was last true, CLOCK_MONOTONIC

  // written by the guardian
  std::atomic<std::int32_t> guardian_pid{0};
  std::atomic<std::uint64_t> guardian_cycles{0};
  std::atomic<std::uint32_t> tripped{0};  ///< 1: the outputs are the guardian's, the controller is fenced out
  /// 1: it has tripped, and the drives carry until the brakes hold. Where it has died of that, 0 is written by whoever
  /// brings the outputs down in its place.
  std::atomic<std::uint32_t> acts{0};
  std::atomic<std::int64_t> acted_at_ns{0};  ///< when it last let them carry, CLOCK_MONOTONIC
  std::atomic<std::uint32_t> reset_done{0};  ///< last reset_request that was granted
  std::atomic<std::uint64_t> machine{0};     ///< machineMark() of what it brings down; 0: it has not said
  std::atomic<std::uint64_t> wiring{0};      ///< machineMark() of how its outputs and brakes are wired
  std::atomic<std::int64_t> silence_ns{0};   ///< after so long without a heartbeat the controller counts as dead
};

/// A machine's name (nodes::machineName()) as a number that is not 0.
std::uint64_t machineMark(const std::string& machine) noexcept;

/// A GuardianLink in POSIX shared memory. Whoever comes first creates it; it outlives each of the two, so a guardian
/// that is started anew finds its latch, and goes when neither lives.
class SharedGuardianLink {
 public:
  /// Throws InputError when the name is malformed, holds something else, or the system refuses.
  static SharedGuardianLink open(const std::string& name);

  SharedGuardianLink(SharedGuardianLink&& other) noexcept;
  SharedGuardianLink& operator=(SharedGuardianLink&& other) = delete;
  SharedGuardianLink(const SharedGuardianLink&) = delete;
  SharedGuardianLink& operator=(const SharedGuardianLink&) = delete;
  /// Takes this process out of the link; removes the name when the other process does not live.
  ~SharedGuardianLink();

  GuardianLink& link() noexcept { return *link_; }
  const std::string& name() const noexcept { return name_; }
  /// The name still leads to this memory. Where somebody has removed it, the two processes go on seeing each other, and
  /// whichever is started next finds nobody.
  bool isNamed() const noexcept;

 private:
  SharedGuardianLink(std::string name, GuardianLink* link, std::uint64_t file)
      : name_(std::move(name)), link_(link), file_(file) {}

  std::string name_;
  GuardianLink* link_;
  std::uint64_t file_;  ///< inode
};

/// A guardian that has tripped lets the drives carry until the brakes hold; whoever brings the outputs down meanwhile
/// lets the platform fall. Waits until that is over. One that has died of it or hangs is waited for for 2 s: the brakes
/// that it ordered engage meanwhile, and a guardian that is started again goes on. False: after 3 s it still carries.
bool letGuardianHandOver(const GuardianLink& link);

/// Whether a process of this number exists (0: no). A zombie does.
bool processExists(std::int32_t pid) noexcept;

}  // namespace knee_robot::hardware
