// What the other axes say of an axis that does not count: it moves, it does not, or nobody can tell.
#include "src/control/pulse_witness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace knee_robot::control {
namespace {

const AxisValues kCount_m{{2e-5, 2e-5, 2e-5, 2e-5}};

/// 8 ms each of +40, -200 and +200 N on axis 2, while the others are on their ways and move with the pulse by `share`
/// of a free mass of 10 kg.
struct Pulse {
  double share = 0.0;
  bool others_are_asked_too = false;
  double dt = 0.001;

  Felt felt() const {
    PulseWitness witness;
    double speed = 0.0, way = 0.0;
    Felt last = Felt::Unknown;
    const int n = static_cast<int>(std::lround(0.024 / dt));
    for (int k = -20; k < n; ++k) {
      const double time = k * dt;
      AxisValues pulses_N{};
      if (k >= 0) pulses_N[1] = time < 0.008 ? 40.0 : time < 0.016 ? -200.0 : 200.0;
      if (others_are_asked_too && k >= 0 && time < 0.006) pulses_N = {30.0, pulses_N[1], -30.0, 30.0};
      speed += dt * pulses_N[1] / 10.0;
      way += dt * speed;
      AxisValues error_m{};
      for (std::size_t i : {0u, 2u, 3u}) {
        const double own = 1e-4 * std::sin(9.0 * time + static_cast<double>(i)) + share * way;
        error_m[i] = kCount_m[i] * std::round(own / kCount_m[i]);
      }
      witness.step(1, dt, pulses_N, error_m);
      last = witness.felt(1, kCount_m);
    }
    return last;
  }
};

TEST(PulseWitness, AnAxisThatMovesUnseenIsFeltByTheOthers) {
  EXPECT_EQ((Pulse{0.2}.felt()), Felt::Yes);
  EXPECT_EQ((Pulse{-0.2}.felt()), Felt::Yes) << "whichever way they are shaken";
}

TEST(PulseWitness, AnAxisThatDoesNotMoveIsNotFeltWhateverTheOthersDo) {
  EXPECT_EQ((Pulse{0.0}.felt()), Felt::No);
}

TEST(PulseWitness, OthersThatGetPulsesThemselvesAreNoWitnesses) {
  EXPECT_EQ((Pulse{0.0, true}.felt()), Felt::Unknown);
  EXPECT_EQ((Pulse{0.2, true}.felt()), Felt::Unknown);
}

TEST(PulseWitness, AServoPeriodOfTwoMillisecondsIsEnough) {
  EXPECT_EQ((Pulse{0.3, false, 0.002}.felt()), Felt::Yes);
  EXPECT_EQ((Pulse{0.0, false, 0.002}.felt()), Felt::No);
}

TEST(PulseWitness, NothingIsKnownBeforeAPulseAndOfOneTooShort) {
  PulseWitness witness;
  EXPECT_EQ(witness.felt(0, kCount_m), Felt::Unknown);
  AxisValues pulses_N{};
  pulses_N[0] = 100.0;
  for (int k = 0; k < 10; ++k)
    witness.step(0, 0.001, pulses_N, AxisValues{});
  EXPECT_EQ(witness.felt(0, kCount_m), Felt::Unknown);
}

}  // namespace
}  // namespace knee_robot::control
