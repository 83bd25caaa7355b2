#pragma once

namespace knee_robot::control {

/// Gains of the position loop.
struct PidGains {
  double proportional = 0.0;          ///< N/m
  double integral = 0.0;              ///< N/(m s)
  double derivative = 0.0;            ///< N s/m
  double derivative_cutoff_hz = 0.0;  ///< low-pass of the measured velocity

  bool operator==(const PidGains& other) const noexcept {
    return proportional == other.proportional && integral == other.integral && derivative == other.derivative &&
           derivative_cutoff_hz == other.derivative_cutoff_hz;
  }
};

/// What the position loop looks at in one cycle.
struct PidInput {
  double reference = 0.0;           ///< m
  double reference_velocity = 0.0;  ///< m/s
  double measured = 0.0;            ///< m
  double feedforward = 0.0;         ///< N, added to the output
  double dt = 0.0;                  ///< s since the last update
  double integral_dead_band = 0.0;  ///< m; the integral sees only what the error is beyond it
};

/// F = P (r - q) + I integral(r - q) + D (r' - q'), with q' a low-passed difference of the measured position (so that
/// the reference's velocity is not filtered), + feedforward; clamped to +-limit. Anti-windup by conditional
/// integration: while the output is clamped, the integral only moves towards the inside; it never exceeds the limit by
/// itself. A dead band for the integral keeps a sticking axis from hunting for an error that its encoder can not
/// resolve.
/// Real-time safe. Anything that is not a number in leads to not a number out, for the caller to refuse.
class Pid {
 public:
  void setGains(const PidGains& gains) noexcept { gains_ = gains; }
  /// While the loop is closed: other gains from the next update on. The integral takes up what the proportional and the
  /// derivative term change by at this `input`, so the output does not jump (where the integral has room: it stays
  /// within the last limit).
  void changeGains(const PidGains& gains, const PidInput& input) noexcept;
  /// Starts at rest at `measured` without integral.
  void reset(double measured) noexcept;
  /// Force in N, within +-`limit`.
  double update(const PidInput& input, double limit) noexcept;
  /// The integral and the feedforward alone, N, while something else moves the axis; only the velocity is followed.
  double follow(const PidInput& input) noexcept;
  /// While the loop is closed: what the caller takes from the feedforward, or gives to it, N. The integral stays within
  /// the last limit.
  void shiftIntegral(double step) noexcept;
  double integral() const noexcept { return integral_; }
  /// The integral, N, which is zero from then on: for a caller that adds it itself.
  double takeIntegral() noexcept {
    const double taken = integral_;
    integral_ = 0.0;
    return taken;
  }

 private:
  void filterVelocity(const PidInput& input) noexcept;

  PidGains gains_;
  double integral_ = 0.0;  // N
  double velocity_ = 0.0;  // m/s, low-passed
  double last_measured_ = 0.0;
  double last_limit_ = 0.0;  // N
};

}  // namespace knee_robot::control
