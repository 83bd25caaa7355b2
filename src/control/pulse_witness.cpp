#include "pulse_witness.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {

constexpr std::size_t kShortest = 8;  // samples
constexpr int kCurve = 3;             // powers of time that the axes may move by on their own

using Samples = std::array<double, PulseWitness::kMost>;

double product(const Samples& a, const Samples& b, std::size_t n) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k)
    sum += a[k] * b[k];
  return sum;
}

/// Takes off `values` what is a multiple of `unit`.
void project(Samples& values, const Samples& unit, std::size_t n) noexcept {
  const double share = product(values, unit, n);
  for (std::size_t k = 0; k < n; ++k)
    values[k] -= share * unit[k];
}

void normalize(Samples& values, std::size_t n) noexcept {
  const double length = std::sqrt(product(values, values, n));
  for (std::size_t k = 0; k < n && length > 0.0; ++k)
    values[k] /= length;
}

}  // namespace

void PulseWitness::step(std::size_t axis, double dt, const AxisValues& pulses_N, const AxisValues& error_m) noexcept {
  const bool pulse = pulses_N[axis] != 0.0;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    own_s_[i] = pulses_N[i] != 0.0 ? 0.0 : own_s_[i] + dt;
  if (pulse && quiet_s_ > kAfter_s) {
    samples_ = 0;
    pulse_s_ = speed_ = way_ = 0.0;
    foreign_.fill(false);
  }
  quiet_s_ = pulse ? 0.0 : quiet_s_ + dt;
  if (quiet_s_ > kAfter_s || samples_ >= kMost) return;
  if (pulse) pulse_s_ += dt;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    foreign_[i] = foreign_[i] || (i != axis && own_s_[i] < kForeign_s);
  way_ += dt * (speed_ + 0.5 * dt * pulses_N[axis]);
  speed_ += dt * pulses_N[axis];
  ways_[samples_] = way_;
  errors_[samples_] = error_m;
  ++samples_;
}

PulseWitness::Answer PulseWitness::answerOf(std::size_t other, double count_m) const noexcept {
  const std::size_t n = samples_;
  Samples way = ways_, error{};
  const auto [lowest, highest] = std::minmax_element(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(n));
  const double range = *highest - *lowest;
  std::array<Samples, kCurve> curve{};
  for (std::size_t k = 0; k < n; ++k) {
    const double time = 2.0 * static_cast<double>(k) / static_cast<double>(n - 1) - 1.0;
    curve[0][k] = 1.0;
    curve[1][k] = time;
    curve[2][k] = time * time;
    way[k] /= range;
    error[k] = errors_[k][other];
  }
  for (std::size_t p = 0; p < curve.size(); ++p) {
    for (std::size_t q = 0; q < p; ++q)
      project(curve[p], curve[q], n);
    normalize(curve[p], n);
    project(way, curve[p], n);
    project(error, curve[p], n);
  }
  const double square = product(way, way, n);
  Answer answer;
  answer.way_m = product(way, error, n) / square;
  for (std::size_t k = 0; k < n; ++k)
    error[k] -= answer.way_m * way[k];
  const double left = product(error, error, n) / static_cast<double>(n - kCurve - 1);
  answer.sigma_m = std::sqrt(std::max(left, count_m * count_m / 12.0) / square);
  answer.way_m = std::abs(answer.way_m);
  return answer;
}

Felt PulseWitness::felt(std::size_t axis, const AxisValues& count_m) const noexcept {
  if (samples_ < kShortest || pulse_s_ < kLeast_s) return Felt::Unknown;
  int asked = 0, say_no = 0;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (i == axis || foreign_[i]) continue;
    ++asked;
    const Answer answer = answerOf(i, count_m[i]);
    const double least = kCounts * count_m[i];
    if (answer.way_m > least && answer.way_m > kSure * answer.sigma_m) return Felt::Yes;
    say_no += answer.way_m < std::max(least, kQuiet * answer.sigma_m) ? 1 : 0;
  }
  return asked >= kWitnesses && say_no == asked ? Felt::No : Felt::Unknown;
}

}  // namespace knee_robot::control
