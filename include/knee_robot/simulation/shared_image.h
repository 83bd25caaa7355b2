#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/simulation/injected_faults.h"
#include "knee_robot/simulation/pci1720_model.h"
#include "knee_robot/simulation/pci1784_model.h"

namespace knee_robot::simulation {

/// What the simulated robot tells about itself for displays and tests. No controller may use it: it is the truth, which
/// a real robot does not tell.
struct RobotStatus {
  std::atomic<double> time_s{0.0};                               ///< simulated time
  std::array<std::atomic<double>, hardware::kAxes> lengths_m{};  ///< true leg lengths
  std::array<std::atomic<double>, hardware::kAxes> pose{};       ///< Xm, Zm (m), theta, psi (rad)
  std::atomic<std::uint8_t> drives_enabled{0};                   ///< bit a: axis a
  std::atomic<std::uint8_t> brakes_engaged{0};                   ///< bit a: axis a
};

/// What people around the simulated robot do; set by tests, fault campaigns and demonstrations.
struct RobotSurroundings {
  std::atomic<std::uint8_t> emergency_stop_pressed{0};
  std::atomic<std::uint8_t> hand_switch_pressed{0};
  std::atomic<std::uint8_t> enabling_switch_held{0};
  std::array<std::atomic<double>, hardware::kAxes> pose_force{};  ///< on Xm, Zm (N), theta, psi (N m)
};

/// The "hardware" of the simulated robot: both cards and the robot's status. Lies in shared memory of its own, or on
/// the heap for stepped simulation.
struct RobotImage {
  static constexpr std::uint64_t kMagic = 0x6b6e65655f726f62;  // "knee_rob"
  static constexpr std::uint32_t kVersion = 5;

  std::atomic<std::uint64_t> magic{0};  ///< written last by the creator
  std::uint32_t version = kVersion;
  std::uint32_t size = 0;
  std::atomic<std::int32_t> plant_pid{0};
  std::atomic<std::uint64_t> plant_heartbeat{0};  ///< counts the plant's steps
  Pci1720Image analog;
  Pci1784Image counter;
  RobotStatus status;
  RobotSurroundings surroundings;
  InjectedFaults faults;
};

/// A RobotImage in POSIX shared memory. The creator (the simulated robot) unlinks the name when it is destroyed; users
/// that attach leave everything as it is, however they end.
class SharedImage {
 public:
  /// Creates `name` ("/knee_robot_sim"). Throws InputError when the name is malformed, when a living process already
  /// simulates under it, or when the system refuses; what a dead one left behind is replaced.
  static SharedImage create(const std::string& name);
  /// Throws InputError when there is no such simulated robot, or one of another version.
  static SharedImage attach(const std::string& name);

  SharedImage(SharedImage&& other) noexcept;
  SharedImage& operator=(SharedImage&& other) = delete;
  SharedImage(const SharedImage&) = delete;
  SharedImage& operator=(const SharedImage&) = delete;
  ~SharedImage();

  RobotImage& image() noexcept { return *image_; }
  const std::string& name() const noexcept { return name_; }

 private:
  SharedImage(std::string name, RobotImage* image, bool owner) : name_(std::move(name)), image_(image), owner_(owner) {}

  std::string name_;
  RobotImage* image_;
  bool owner_;
};

}  // namespace knee_robot::simulation
