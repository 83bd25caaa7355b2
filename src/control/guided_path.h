#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "knee_robot/control/answer.h"
#include "knee_robot/control/patient_limits.h"

namespace knee_robot::control {

/// The lengths along which the platform was guided, one sample every 10 ms. One real-time writer; readers of other
/// threads may look while nothing is guided. All memory is taken at construction.
class GuidedPath {
 public:
  static constexpr std::size_t kMostSamples = 60'000;  // ten minutes

  GuidedPath() : samples_(kMostSamples) {}
  /// Forgets, for a new path. Real-time safe, as add() and measure().
  void begin() noexcept {
    number_.fetch_add(1, std::memory_order_acq_rel);
    count_.store(0, std::memory_order_release);
  }
  /// Each cycle: the axes know where they are (`homed`), by the home of this number. Lengths by another one, or by
  /// counts that turned out to be wrong, are no path any more.
  void measure(bool homed, std::uint32_t home_number) noexcept {
    if (homed && home_number == home_number_) return;
    home_number_ = home_number;
    if (size() > 0) begin();
  }
  /// False when it is full.
  bool add(const std::array<double, 4>& lengths_m) noexcept;
  std::size_t size() const noexcept { return count_.load(std::memory_order_acquire); }
  /// N x 4, m; none when the next guiding has begun meanwhile.
  trajectory::Points points() const;

 private:
  std::vector<std::array<double, 4>> samples_;
  std::atomic<std::size_t> count_{0};
  std::atomic<std::uint32_t> number_{0};  // of the path
  std::uint32_t home_number_ = 0;         // of the writer
};

/// A guided path as a reference that may be played: rests at the ends cut to `rest_s`, zero-phase low-pass, beginning
/// and end at rest, and as slow as the robot's (and patient's) limits want it. `slowed`: by which factor the hand was
/// faster. InputError: one sentence, when nothing moved or the path leaves what may be played.
struct GuidedReference {
  trajectory::Reference reference;
  double slowed = 1.0;
};
GuidedReference guidedReference(const trajectory::Points& guided, const mechanism::Robot& robot,
                                const std::optional<PatientLimits>& patient);

/// Writes it as a reference file; what was written, and a sentence about it. InputError likewise, and when the file cannot be written.
SavedReference saveGuidedReference(const std::string& path, const trajectory::Points& guided,
                                   const mechanism::Robot& robot, const std::optional<PatientLimits>& patient);

}  // namespace knee_robot::control
