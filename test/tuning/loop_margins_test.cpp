// Margins against loops that really run: the product's control::Pid on an axis that is integrated in steps of 20 us.
#include "knee_robot/tuning/loop_margins.h"

#include <gtest/gtest.h>

#include "knee_robot/tuning/gain_proposal.h"
#include "test/control/simulated_axis.h"

namespace knee_robot::tuning {
namespace {

constexpr double kPeriod = 0.001;
const control::PidGains kGains{60000.0, 300000.0, 1500.0, 100.0};

control::PidGains times(control::PidGains gains, double factor) {
  gains.proportional *= factor;
  gains.integral *= factor;
  gains.derivative *= factor;
  return gains;
}

fake::SimulatedAxis axisOf(const AxisPlant& plant) {
  fake::SimulatedAxis axis;
  axis.mass_kg = plant.mass_kg;
  axis.viscous = plant.viscous_N_s_per_m;
  axis.delay_s = plant.delay_s;
  return axis;
}

bool comesToRest(const control::PidGains& gains, const AxisPlant& plant) {
  return fake::growth(gains, axisOf(plant), kPeriod, 6.0) < 1.0;
}

/// Where between a stable and an unstable value the running loop changes sides.
double critical(double stable, double unstable, const std::function<bool(double)>& rests) {
  for (int k = 0; k < 12; ++k) {
    const double middle = std::sqrt(stable * unstable);
    (rests(middle) ? stable : unstable) = middle;
  }
  return std::sqrt(stable * unstable);
}

const AxisPlant kPlants[] = {{8.0, 0.0, 0.0}, {12.0, 150.0, 0.0013}, {30.0, 60.0, 0.002}};

TEST(LoopMargins, OfTheGainAreWhereTheRunningLoopBecomesUnstable) {
  for (const AxisPlant& plant : kPlants) {
    const LoopMargins margins = loopMargins(kGains, plant, kPeriod);
    ASSERT_TRUE(margins.stable);
    const double up =
        critical(1.0, 3.0 * margins.gain_up, [&](double f) { return comesToRest(times(kGains, f), plant); });
    EXPECT_NEAR(margins.gain_up / up, 1.0, 0.005) << plant.mass_kg;
    if (plant.viscous_N_s_per_m > 0.0) continue;
    ASSERT_GT(margins.gain_down, 0.0) << "without friction the integral needs the proportional part";
    const double down =
        critical(1.0, margins.gain_down / 3.0, [&](double f) { return comesToRest(times(kGains, f), plant); });
    EXPECT_NEAR(margins.gain_down / down, 1.0, 0.05);
  }
}

TEST(LoopMargins, OfTheDelayAreWhereTheRunningLoopBecomesUnstable) {
  for (const AxisPlant& plant : kPlants) {
    const LoopMargins margins = loopMargins(kGains, plant, kPeriod);
    const double more = critical(1e-5, 3.0 * margins.delay_s, [&](double delay) {
      return comesToRest(kGains, {plant.mass_kg, plant.viscous_N_s_per_m, plant.delay_s + delay});
    });
    EXPECT_NEAR(1e3 * margins.delay_s, 1e3 * more, 0.05) << plant.mass_kg;
    EXPECT_LE(margins.phase_rad, 2.0 * M_PI * margins.crossover_hz * margins.delay_s + 1e-3);
  }
}

/// A frequency response by hand: the loop is cut, a sine goes in, and what comes out is correlated with it.
std::complex<double> measuredLoop(const control::PidGains& gains, const AxisPlant& plant, double frequency) {
  fake::SimulatedAxis axis = axisOf(plant);
  const double w = 2.0 * M_PI * frequency, amplitude = 100.0;
  const std::complex<double> j(0.0, 1.0);
  // The answer to a force that began long ago: the start's drift of a free mass is the line through the first and last
  // period.
  const int cycles = static_cast<int>(std::lround(20.0 / frequency / kPeriod));
  const int one = static_cast<int>(std::lround(1.0 / frequency / kPeriod));
  std::vector<double> position;
  axis.velocity = -amplitude / (w * axis.mass_kg);
  for (int k = 0; k < cycles; ++k) {
    position.push_back(axis.position);
    axis.advance(amplitude * std::sin(w * k * kPeriod), kPeriod);
  }
  const int from = cycles - 10 * one;
  const double drift =
      (position[static_cast<std::size_t>(cycles - 1)] - position[static_cast<std::size_t>(cycles - 1 - 5 * one)]) /
      (5 * one);
  std::complex<double> sum = 0.0;
  for (int k = from; k < cycles; ++k)
    sum += (position[static_cast<std::size_t>(k)] - drift * k) * std::exp(-j * w * (k * kPeriod));
  double offset = 0.0;
  for (int k = from; k < cycles; ++k)
    offset += (position[static_cast<std::size_t>(k)] - drift * k) / (cycles - from);
  for (int k = from; k < cycles; ++k)
    sum -= offset * std::exp(-j * w * (k * kPeriod));
  const std::complex<double> per_force = 2.0 * j * sum / static_cast<double>(cycles - from) / amplitude;
  // The Pid's own part, run in the same way: error in, force out.
  control::Pid pid;
  pid.setGains(gains);
  pid.reset(0.0);
  std::complex<double> force = 0.0;
  double constant = 0.0;
  std::vector<double> out;
  for (int k = 0; k < cycles; ++k) {
    control::PidInput input;
    input.measured = -std::sin(w * k * kPeriod);
    input.dt = kPeriod;
    out.push_back(pid.update(input, 1e12));
  }
  for (int k = from; k < cycles; ++k)
    constant += out[static_cast<std::size_t>(k)] / (cycles - from);
  for (int k = from; k < cycles; ++k)
    force += (out[static_cast<std::size_t>(k)] - constant) * std::exp(-j * w * (k * kPeriod));
  return per_force * 2.0 * j * force / static_cast<double>(cycles - from);
}

TEST(LoopMargins, RestOnAResponseThatTheRunningPartsHaveToo) {
  for (const AxisPlant& plant : kPlants) {
    for (const double frequency : {5.0, 20.0, 50.0}) {
      const std::complex<double> expected =
          pidResponse(kGains, kPeriod, frequency) * plantResponse(plant, kPeriod, frequency);
      const std::complex<double> measured = measuredLoop(kGains, plant, frequency);
      EXPECT_NEAR(std::abs(measured / expected), 1.0, 0.02) << plant.mass_kg << " kg at " << frequency << " Hz";
      EXPECT_NEAR(std::arg(measured / expected), 0.0, 0.02) << plant.mass_kg << " kg at " << frequency << " Hz";
    }
  }
}

TEST(LoopMargins, SayWhenALoopIsUnstable) {
  EXPECT_FALSE(loopMargins(times(kGains, 20.0), kPlants[0], kPeriod).stable);
  EXPECT_FALSE(loopMargins({60000.0, 3e7, 100.0, 100.0}, kPlants[0], kPeriod).stable);
  EXPECT_TRUE(loopMargins(kGains, {8.0, 1e-12, 0.0}, kPeriod).stable) << "hardly any friction is like none";
}

TEST(GainProposal, KeepsItsMarginOnEveryAxisOfTheRangeThatRuns) {
  const PlantRange range{{6.0, 0.0, 0.0005}, {20.0, 200.0, 0.002}};
  const MarginDemand demand;
  const auto gains = proposeGains(range, kPeriod, demand, {50.0, 1e-5, 20.0});
  ASSERT_TRUE(gains);
  EXPECT_TRUE(demand.isMetBy(worstMargins(*gains, range, kPeriod)));
  for (const AxisPlant& plant : range.corners()) {
    EXPECT_TRUE(comesToRest(times(*gains, 0.98 * demand.gain), plant)) << plant.mass_kg << " kg";
    EXPECT_TRUE(comesToRest(times(*gains, 1.02 / demand.gain), plant)) << plant.mass_kg << " kg";
  }
  const AxisPlant between{11.0, 80.0, 0.001};
  EXPECT_TRUE(demand.isMetBy(loopMargins(*gains, between, kPeriod))) << "within the range, not at its corners";
}

TEST(GainProposal, IsAsFastAsTheDemandAllowsAndNoFaster) {
  const PlantRange range{{8.0, 0.0, 0.001}, {12.0, 100.0, 0.001}};
  const MarginDemand demand;
  const auto gains = proposeGains(range, kPeriod, demand, {200.0, 1e-6, 1000.0});
  ASSERT_TRUE(gains);
  control::PidGains faster = *gains;
  faster.derivative *= 1.1;
  faster.proportional *= 1.21;
  faster.integral *= 1.331;
  faster.derivative_cutoff_hz = std::min(200.0, 1.1 * faster.derivative_cutoff_hz);
  EXPECT_FALSE(demand.isMetBy(worstMargins(faster, range, kPeriod)));
}

TEST(GainProposal, StaysBelowWhatTheRecordingShowsAndWhatTheEncoderBears) {
  const PlantRange range{{8.0, 0.0, 0.0005}, {12.0, 100.0, 0.001}};
  const auto free = proposeGains(range, kPeriod, {}, {100.0, 1e-6, 1000.0});
  const auto low = proposeGains(range, kPeriod, {}, {5.0, 1e-6, 1000.0});
  const auto coarse = proposeGains(range, kPeriod, {}, {100.0, 20e-6, 3.0});
  ASSERT_TRUE(free && low && coarse);
  EXPECT_LE(worstMargins(*low, range, kPeriod).crossover_hz, 5.0);
  EXPECT_LE(kickOfOneCount(*coarse, kPeriod, 20e-6), 3.0);
  EXPECT_LT(coarse->proportional, free->proportional);
}

TEST(GainProposal, IsNoneWhereNoGainsKeepTheMargin) {
  EXPECT_FALSE(proposeGains({{2.0, 0.0, 0.001}, {60.0, 0.0, 0.001}}, kPeriod, {}, {}))
      << "a range of 30 to 1 is too wide for one set of gains";
  EXPECT_FALSE(proposeGains({{10.0, 0.0, 0.0}, {10.0, 0.0, 0.0}}, kPeriod, {}, {50.0, 1e-3, 0.001}))
      << "an encoder that is too coarse for any";
}

TEST(GainProposal, CountsTheForceOfOneEncoderCountAsTheLoopDoes) {
  control::Pid pid;
  pid.setGains(kGains);
  pid.reset(0.0);
  control::PidInput input;
  input.dt = kPeriod;
  input.measured = 20e-6;
  const double force = -pid.update(input, 1e9) - kGains.integral * kPeriod * 20e-6;
  EXPECT_NEAR(kickOfOneCount(kGains, kPeriod, 20e-6), force, 1e-9);
}

}  // namespace
}  // namespace knee_robot::tuning
