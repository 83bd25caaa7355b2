#include "src/control/request_numbers.h"

#include <gtest/gtest.h>

#include <vector>

namespace knee_robot::control {
namespace {

constexpr std::uint32_t kPlaces = SupervisorStatus::kAnswers;

TEST(RequestNumbers, NeverGiveThePlaceOfAnAnswerThatSomebodyLooksForToAnother) {
  RequestNumbers numbers;
  const std::uint32_t patient = *numbers.take();
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t other = *numbers.take();
    ASSERT_NE(other % kPlaces, patient % kPlaces) << i;
    numbers.giveBack(other);
  }
}

TEST(RequestNumbers, RunOutWhileAllPlacesAreLookedAtAndComeBack) {
  RequestNumbers numbers;
  std::vector<std::uint32_t> taken;
  for (std::uint32_t i = 0; i < kPlaces; ++i)
    taken.push_back(*numbers.take());
  EXPECT_FALSE(numbers.take());
  numbers.giveBack(taken[3]);
  const std::uint32_t again = *numbers.take();
  EXPECT_EQ(again % kPlaces, taken[3] % kPlaces);
  EXPECT_GT(again, taken.back()) << "a number is never given twice";
}

}  // namespace
}  // namespace knee_robot::control
