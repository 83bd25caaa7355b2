#include "src/identification/friction_shared.h"

#include <gtest/gtest.h>

namespace knee_robot::identification {
namespace {

constexpr int kTanhFamily = 1, kRootFamily = 4;

TriedLaw tried(int family, double beyond_best, double standard_error) {
  TriedLaw t;
  t.family = family;
  t.law = dynamics::stopLaw(1e-6 * family);  // which law it is, is all that matters here
  t.held_back = 1.3 + beyond_best;
  t.beyond_best = beyond_best;
  t.standard_error = standard_error;
  return t;
}

FrictionChoice chosen(int family, const TriedLaw& tanh, const TriedLaw& root) {
  FrictionChoice c;
  c.tried = {tanh, root};
  c.family = family;
  c.law = family == kTanhFamily ? tanh.law : root.law;
  return c;
}

/// Actuators of which the first ones have tanh, and the others the root law, of which tanh is so many standard errors
/// worse.
std::vector<FrictionChoice> machine(int with_tanh, int with_root, double errors) {
  const TriedLaw best_tanh = tried(kTanhFamily, 0.0, 0.01), best_root = tried(kRootFamily, 0.0, 0.01);
  std::vector<FrictionChoice> all(static_cast<std::size_t>(with_tanh),
                                  chosen(kTanhFamily, best_tanh, tried(kRootFamily, 0.05, 0.01)));
  all.insert(all.end(), static_cast<std::size_t>(with_root),
             chosen(kRootFamily, tried(kTanhFamily, 0.01 * errors, 0.01), best_root));
  return all;
}

int withTanh(std::vector<FrictionChoice> all) {
  shareFamily(all);
  int count = 0;
  for (const FrictionChoice& c : all)
    count += c.family == kTanhFamily && c.law == dynamics::stopLaw(1e-6 * kTanhFamily);
  return count;
}

TEST(SharedFamily, OfHalfOfTheActuatorsIsTheOthersUnlessTheirsIsBetterByTwoStandardErrors) {
  EXPECT_EQ(withTanh(machine(2, 2, 1.5)), 4);
  EXPECT_EQ(withTanh(machine(2, 2, 2.5)), 2);
}

TEST(SharedFamily, OfThreeQuartersIsTheOthersUnlessTheirsIsBetterByThree) {
  EXPECT_EQ(withTanh(machine(3, 1, 2.5)), 4);
  EXPECT_EQ(withTanh(machine(3, 1, 3.5)), 3);
}

TEST(SharedFamily, IsNoneWhereFewerThanHalfHaveIt) {
  EXPECT_EQ(withTanh(machine(1, 3, 1.5)), 1) << "three keep the root law, and one its own, better by five";
  EXPECT_EQ(withTanh(machine(1, 0, 0.0)), 1) << "one alone shares nothing";
}

TEST(SharedFamily, IsNotTakenWhereItLeavesATenthMore) {
  std::vector<FrictionChoice> all = machine(3, 1, 1.0);
  all.back().tried.front() = tried(kTanhFamily, 0.2, 1.0);
  EXPECT_EQ(withTanh(all), 3) << "few blocks may hold all of the difference, and then its error is large";
}

}  // namespace
}  // namespace knee_robot::identification
