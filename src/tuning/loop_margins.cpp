#include "knee_robot/tuning/loop_margins.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "knee_robot/base/constants.h"

namespace knee_robot::tuning {
namespace {

constexpr int kFrequencies = 3000;
constexpr double kLowest_hz = 0.05;

using Complex = std::complex<double>;

/// What a constant force does in a time: position and velocity for 1 N, and how velocity goes on by itself.
struct Held {
  double position, velocity, travel, decay;
};

Held held(const AxisPlant& plant, double time) {
  const double m = plant.mass_kg, rate = plant.viscous_N_s_per_m / m, x = rate * time;
  if (std::abs(x) < 1e-4) {  // series: the quotients below lose their digits
    const double travel = time * (1.0 - x / 2.0 + x * x / 6.0);
    return {time * time / m * (0.5 - x / 6.0 + x * x / 24.0), travel / m, travel, std::exp(-x)};
  }
  const double decay = std::exp(-x), travel = (1.0 - decay) / rate;
  return {(time - travel) / (rate * m), travel / m, travel, decay};
}

/// One period of the plant: x = (position, velocity), the force of `whole` periods ago and the one before it.
struct Sampled {
  double a01, a11;  // A = [1 a01; 0 a11]
  double newer[2], older[2];
  int whole;
};

Sampled sample(const AxisPlant& plant, double period) {
  Sampled s;
  s.whole = static_cast<int>(std::floor(plant.delay_s / period + 1e-9));
  const double fraction = std::max(0.0, plant.delay_s - s.whole * period);
  const Held all = held(plant, period), first = held(plant, fraction), rest = held(plant, period - fraction);
  s.a01 = all.travel;
  s.a11 = all.decay;
  s.newer[0] = rest.position;
  s.newer[1] = rest.velocity;
  s.older[0] = first.position + rest.travel * first.velocity;
  s.older[1] = rest.decay * first.velocity;
  return s;
}

double filterShare(const control::PidGains& gains, double period) {
  return period / (1.0 / (2.0 * kPi * gains.derivative_cutoff_hz) + period);
}

Complex onCircle(double frequency, double period) {
  return std::polar(1.0, 2.0 * kPi * frequency * period);
}

Complex respond(const Sampled& s, Complex z) {
  const Complex u = std::pow(z, -s.whole), older = u / z;
  const Complex velocity = (s.newer[1] * u + s.older[1] * older) / (z - s.a11);
  return (s.a01 * velocity + s.newer[0] * u + s.older[0] * older) / (z - 1.0);
}

/// The loop as a linear map from one cycle to the next: position, velocity, forces under way, the Pid's memory.
class LinearLoop {
 public:
  LinearLoop(const control::PidGains& gains, const AxisPlant& plant, double period)
      : gains_(gains), s_(sample(plant, period)), period_(period), alpha_(filterShare(gains, period)) {}
  int states() const { return 5 + s_.whole + 1; }

  Eigen::VectorXd step(const Eigen::VectorXd& x, double reference) const {
    Eigen::VectorXd next = x;
    const double position = x[0], velocity = x[1], error = reference - position;
    const double filtered = x[3] + alpha_ * ((position - x[4]) / period_ - x[3]);
    const double integral = x[2] + gains_.integral * period_ * error;
    const double force = gains_.proportional * error + integral - gains_.derivative * filtered;
    const auto ago = [&](int cycles) { return cycles == 0 ? force : x[4 + cycles]; };
    next[0] = position + s_.a01 * velocity + s_.newer[0] * ago(s_.whole) + s_.older[0] * ago(s_.whole + 1);
    next[1] = s_.a11 * velocity + s_.newer[1] * ago(s_.whole) + s_.older[1] * ago(s_.whole + 1);
    next[2] = integral;
    next[3] = filtered;
    next[4] = position;
    for (int k = 1; k <= s_.whole + 1; ++k)
      next[4 + k] = ago(k - 1);
    return next;
  }

  bool isStable() const {
    Eigen::MatrixXd map(states(), states());
    for (int k = 0; k < states(); ++k)
      map.col(k) = step(Eigen::VectorXd::Unit(states(), k), 0.0);
    if (!map.allFinite()) return false;
    const Eigen::VectorXcd eigenvalues = map.eigenvalues();
    double largest = eigenvalues.cwiseAbs().maxCoeff();
    return largest < 1.0 - 1e-9;
  }

 private:
  const control::PidGains gains_;
  const Sampled s_;
  const double period_, alpha_;
};

/// Where a value that changes between two neighbours passes zero, as a share of the way.
double crossing(double from, double to) {
  return from / (from - to);
}

}  // namespace

Complex pidResponse(const control::PidGains& gains, double period, double frequency) {
  const Complex z = onCircle(frequency, period);
  const double alpha = filterShare(gains, period);
  const Complex derivative = alpha * (1.0 - 1.0 / z) / period / (1.0 - (1.0 - alpha) / z);
  return gains.proportional + gains.integral * period * z / (z - 1.0) + gains.derivative * derivative;
}

Complex plantResponse(const AxisPlant& plant, double period, double frequency) {
  return respond(sample(plant, period), onCircle(frequency, period));
}

std::vector<double> marginFrequencies(double period) {
  std::vector<double> all;
  const double span = std::log(0.4999 / period / kLowest_hz);
  for (int k = 0; k < kFrequencies; ++k)
    all.push_back(kLowest_hz * std::exp(span * k / (kFrequencies - 1)));
  return all;
}

LoopMargins loopMargins(const control::PidGains& gains, const AxisPlant& plant, double period) {
  LoopMargins margins;
  margins.stable = LinearLoop(gains, plant, period).isStable();
  margins.gain_up = std::numeric_limits<double>::infinity();
  margins.phase_rad = kPi;
  margins.delay_s = std::numeric_limits<double>::infinity();
  const Sampled sampled = sample(plant, period);
  double last_f = 0.0;
  Complex last;
  for (const double f : marginFrequencies(period)) {
    const Complex loop = pidResponse(gains, period, f) * respond(sampled, onCircle(f, period));
    margins.sensitivity = std::max(margins.sensitivity, 1.0 / std::abs(1.0 + loop));
    if (last_f > 0.0 && loop.imag() * last.imag() <= 0.0) {
      const double real = last.real() + crossing(last.imag(), loop.imag()) * (loop.real() - last.real());
      if (real < -1.0) margins.gain_down = std::max(margins.gain_down, -1.0 / real);
      if (real < 0.0 && real > -1.0) margins.gain_up = std::min(margins.gain_up, -1.0 / real);
    }
    const double before = std::log(std::abs(last)), now = std::log(std::abs(loop));
    if (last_f > 0.0 && before * now <= 0.0) {
      const double share = crossing(before, now), at = last_f + share * (f - last_f);
      const double phase = std::arg(-(last + share * (loop - last)));  // 0: on the critical point; positive: before it
      margins.phase_rad = std::min(margins.phase_rad, std::abs(phase));
      margins.crossover_hz = at;
      const double room = phase > 0.0 ? phase : phase + 2.0 * kPi;  // a delay turns clockwise
      margins.delay_s = std::min(margins.delay_s, room / (2.0 * kPi * at));
    }
    last = loop;
    last_f = f;
  }
  return margins;
}

std::vector<double> stepResponse(const control::PidGains& gains, const AxisPlant& plant, double period, int samples) {
  const LinearLoop loop(gains, plant, period);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(loop.states());
  std::vector<double> position;
  for (int k = 0; k < samples; ++k) {
    position.push_back(x[0]);
    x = loop.step(x, 1.0);
  }
  return position;
}

}  // namespace knee_robot::tuning
