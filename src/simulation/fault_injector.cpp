#include "knee_robot/simulation/fault_injector.h"

namespace knee_robot::simulation {

FaultInjector::Values FaultInjector::volts(const Values& asked) noexcept {
  const std::uint8_t mask = faults_.converter_stuck.load(std::memory_order_relaxed);
  Values given = asked;
  for (std::size_t i = 0; i < kChannels; ++i) {
    if ((mask >> i & 1u) == 0) continue;
    if ((stuck_ >> i & 1u) == 0) stuck_at_[i] = asked[i];
    given[i] = stuck_at_[i];
  }
  stuck_ = mask;
  return given;
}

FaultInjector::Values FaultInjector::counts(const Values& truth, const Values& counts_per_m) noexcept {
  constexpr double kDither = 2.0;  // counts
  Values seen = truth;
  for (std::size_t i = 0; i < kChannels; ++i) {
    const auto fault = static_cast<EncoderFault>(faults_.encoder[i].load(std::memory_order_relaxed));
    const double size = faults_.encoder_size_m[i].load(std::memory_order_relaxed) * counts_per_m[i];
    if (fault != active_[i]) {
      if (active_[i] == EncoderFault::Interrupted) missed_[i] += at_onset_[i] - truth[i];
      at_onset_[i] = truth[i];
    }
    active_[i] = fault;
    switch (fault) {
      case EncoderFault::None:
        break;
      case EncoderFault::Frozen:
        seen[i] = at_onset_[i];
        break;
      case EncoderFault::Interrupted:
        seen[i] = at_onset_[i] + size * random();
        break;
      case EncoderFault::Jump:
        seen[i] += size;
        break;
      case EncoderFault::WrongSign:
        seen[i] = 2.0 * at_onset_[i] - truth[i];
        break;
      case EncoderFault::Noise:
        seen[i] += size * random();
        break;
      case EncoderFault::Disconnected:
        seen[i] = at_onset_[i] + kDither * random();
        break;
    }
    seen[i] += missed_[i];
  }
  return seen;
}

/// xorshift64.
double FaultInjector::random() noexcept {
  random_ ^= random_ << 13;
  random_ ^= random_ >> 7;
  random_ ^= random_ << 17;
  return 2.0 * static_cast<double>(random_ >> 11) / 9007199254740992.0 - 1.0;
}

}  // namespace knee_robot::simulation
