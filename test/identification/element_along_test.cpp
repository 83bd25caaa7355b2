#include "src/identification/element_along.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "src/identification/friction_families.h"

namespace knee_robot::identification {
namespace {

/// Moves, reverses with a wiggle, rests and moves on; trembles in the second half.
SlidingPath path() {
  constexpr double kPeriod_s = 0.01;
  constexpr int kSamples = 900;
  Eigen::VectorXd position(kSamples), velocity(kSamples);
  for (int n = 0; n < kSamples; ++n) {
    const double t = n * kPeriod_s, moves = t < 3.0 || t > 5.0 ? 1.0 : 0.0, at = moves > 0.0 ? t : 3.0;
    position[n] = 4e-3 * std::sin(1.7 * at) + moves * 3e-6 * std::sin(60.0 * t);
    velocity[n] = moves * (4e-3 * 1.7 * std::cos(1.7 * at) + 1.8e-4 * std::cos(60.0 * t));
  }
  SlidingPath p = slidingPath(position, velocity, kPeriod_s, 5e-6);
  p.tremble = Eigen::VectorXd::Zero(kSamples);
  std::mt19937 random(3);
  for (int n = kSamples / 2; n < kSamples; ++n)
    p.tremble[n] = std::uniform_real_distribution<double>(0.0, 2e-4)(random);
  return p;
}

/// Of a smooth law: its friction is that of the velocity around each substep, not of the one that ends there.
Eigen::VectorXd stepsAround(const SlidingPath& p, const dynamics::FrictionElement& element) {
  const Eigen::VectorXd& x = p.measured;
  const Eigen::Index last = x.size() - 1;
  dynamics::FrictionLaw law;
  law.elements[0] = element;
  law.elements[0].share = 1.0;
  dynamics::FrictionState state;
  Eigen::VectorXd share(x.size());
  for (Eigen::Index k = 0; k <= last; ++k) {
    const Eigen::Index from = std::max<Eigen::Index>(0, k - 1), to = std::min(last, k + 1);
    share[k] =
        state.step(law, (x[to] - x[from]) / static_cast<double>(to - from), p.period_s / SlidingPath::kSubsteps, 0.0);
  }
  return share;
}

Eigen::VectorXd oneStepAfterTheOther(const SlidingPath& p, const dynamics::FrictionElement& element, double at_start) {
  const Eigen::VectorXd& x = element.kind == dynamics::FrictionKind::Stop ? p.position : p.measured;
  dynamics::FrictionLaw law;
  law.elements[0] = element;
  law.elements[0].share = 1.0;
  dynamics::FrictionState state;
  if (element.kind == dynamics::FrictionKind::Smooth) return stepsAround(p, element);
  state.start(at_start);
  Eigen::VectorXd share = Eigen::VectorXd::Constant(x.size(), at_start);
  for (Eigen::Index k = 1; k < x.size(); ++k)
    share[k] =
        state.step(law, x[k] - x[k - 1], p.period_s / SlidingPath::kSubsteps, p.tremble[k / SlidingPath::kSubsteps]);
  return share;
}

TEST(ElementAlong, EveryElementThatIsTriedIsWhatFrictionDoesStepByStep) {
  const SlidingPath p = path();
  FrictionRange range;
  range.growing_m_per_s = 0.02;
  std::vector<dynamics::FrictionElement> all = elementsToTry(range);
  for (const double exponent : {0.6, 1.37, 3.0}) {
    all.push_back({dynamics::FrictionKind::Bristles, 1.0, 1e-4, 0.0, exponent > 1.0 ? 2e-3 : 0.0});
    all.back().exponent = exponent;
  }
  for (const double at_start : {0.0, -0.6, 1.0}) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Eigen::VectorXd expected = oneStepAfterTheOther(p, all[k], at_start);
      EXPECT_LT((elementAlong(p, all[k], at_start) - expected).cwiseAbs().maxCoeff(), 1e-9) << "element " << k;
      EXPECT_GT(expected.maxCoeff() - expected.minCoeff(), 0.5) << "element " << k << " does next to nothing";
    }
  }
}

TEST(ElementAlong, APathOfOneSampleIsWhatItBeginsWith) {
  const SlidingPath p = slidingPath(Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd::Zero(1), 0.01, 1e-6);
  EXPECT_EQ(elementAlong(p, dynamics::stopLaw(1e-5).elements[0], -0.4)[0], -0.4);
}

}  // namespace
}  // namespace knee_robot::identification
