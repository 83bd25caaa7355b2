#include "src/control/request_answers.h"

#include <gtest/gtest.h>

namespace knee_robot::control {
namespace {

const RequestAnswer& of(const RequestAnswers& answers, std::uint32_t number) {
  return answers.all()[number % answers.all().size()];
}

TEST(RequestAnswering, SettlesTheRequestThatWaitsOnce) {
  RequestAnswers answers;
  answers.await(7);
  EXPECT_TRUE(answers.isAwaiting());
  answers.settle(RequestResult::NotAtStart, 2, 0.01);
  EXPECT_FALSE(answers.isAwaiting());
  answers.settle(RequestResult::Done);
  EXPECT_EQ(of(answers, 7).number, 7u);
  EXPECT_EQ(of(answers, 7).result, RequestResult::NotAtStart);
  EXPECT_EQ(of(answers, 7).axis, 2);
}

TEST(RequestAnswering, KeepsTheAnswersToTheLastRequests) {
  constexpr std::uint32_t kLast = SupervisorStatus::kAnswers + 1;
  RequestAnswers answers;
  for (std::uint32_t number = 1; number <= kLast; ++number)
    answers.answer(number, RequestResult::Done);
  EXPECT_EQ(of(answers, 2).number, 2u);
  EXPECT_EQ(of(answers, kLast).number, kLast);
  EXPECT_EQ(of(answers, 1).number, kLast) << "the oldest one's place was taken";
}

TEST(RequestAnswering, SettlesAllThatWaitForTheSame) {
  RequestAnswers answers;
  answers.await(3);
  answers.answer(4, RequestResult::Done);
  answers.await(5);
  answers.settle(RequestResult::Done);
  EXPECT_EQ(of(answers, 3).result, RequestResult::Done);
  EXPECT_EQ(of(answers, 3).number, 3u);
  EXPECT_EQ(of(answers, 5).number, 5u);
  EXPECT_FALSE(answers.isAwaiting());
}

TEST(RequestAnswering, TellsTheOldestWhereTooManyWait) {
  constexpr std::uint32_t kTooMany = SupervisorStatus::kAnswers / 2 + 1;
  RequestAnswers answers;
  for (std::uint32_t number = 1; number <= kTooMany; ++number)
    answers.await(number);
  EXPECT_EQ(of(answers, 1).number, 1u);
  EXPECT_EQ(of(answers, 1).result, RequestResult::Superseded);
  answers.settle(RequestResult::Done);
  EXPECT_EQ(of(answers, 1).result, RequestResult::Superseded);
  for (std::uint32_t number = 2; number <= kTooMany; ++number)
    EXPECT_EQ(of(answers, number).result, RequestResult::Done) << number;
}

TEST(RequestAnswering, ANewStartForgetsWhoWaitsAndKeepsWhatWasAnswered) {
  RequestAnswers answers;
  answers.answer(1, RequestResult::NotReady);
  answers.await(2);
  answers.dropPending();
  answers.settle(RequestResult::Done);
  EXPECT_EQ(of(answers, 1).result, RequestResult::NotReady);
  EXPECT_EQ(of(answers, 2).number, 0u);
}

TEST(RequestAnswers, ThatComeTooLateDoNotTakeThePlaceOfANewerOne) {
  constexpr std::uint32_t kPlaces = SupervisorStatus::kAnswers;
  RequestAnswers answers;
  answers.await(3);
  answers.answer(3 + kPlaces, RequestResult::Done);
  answers.settle(RequestResult::Superseded);
  EXPECT_EQ(answers.all()[3].number, 3 + kPlaces);
  EXPECT_EQ(answers.all()[3].result, RequestResult::Done);
}

}  // namespace
}  // namespace knee_robot::control
