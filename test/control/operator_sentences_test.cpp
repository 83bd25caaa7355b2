#include "src/control/operator_sentences.h"

#include <gtest/gtest.h>

#include <set>

namespace knee_robot::control {
namespace {

Answer said(RequestResult result, HomingMethod homing = HomingMethod::Assumed,
            RequestKind asked = RequestKind::Enable) {
  ControlStatus now;
  now.state = MachineState::Holding;
  now.fault_sentence = "axis 2: stalled";
  now.guiding = "the platform's pose is not known";
  RequestAnswer answer;
  answer.result = result;
  answer.axis = 3;
  answer.distance_m = 0.0123;
  return sentenceOf(asked, answer, now, homing, 0.002);
}

TEST(OperatorSentences, SayOfEveryRequestWhatBecameOfItEachInItsOwnWords) {
  std::set<std::string> sentences;
  for (int i = 0; i <= static_cast<int>(RequestResult::TooLate); ++i) {
    const Answer answer = said(static_cast<RequestResult>(i));
    EXPECT_EQ(answer.ok, i == static_cast<int>(RequestResult::Done));
    EXPECT_GT(answer.sentence.size(), 10u) << i;
    EXPECT_TRUE(sentences.insert(answer.sentence).second) << answer.sentence;
  }
}

TEST(OperatorSentences, SayHowFarWhichAxisIsFromTheStart) {
  const std::string sentence = said(RequestResult::NotAtStart).sentence;
  EXPECT_NE(sentence.find("axis 3 stands 12.3 mm"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("2 mm allowed"), std::string::npos) << sentence;
}

TEST(OperatorSentences, SayOfAFaultItsCause) {
  for (const RequestResult result :
       {RequestResult::WrongState, RequestResult::CauseRemains, RequestResult::NeedsRestart, RequestResult::Failed}) {
    EXPECT_NE(said(result).sentence.find("axis 2: stalled"), std::string::npos);
  }
}

TEST(OperatorSentences, BlameNoStateInWhichItIsPossible) {
  const std::string sentence = said(RequestResult::WrongState, HomingMethod::Assumed, RequestKind::Play).sentence;
  EXPECT_NE(sentence.find("has just left; now it is holding"), std::string::npos) << sentence;
}

TEST(OperatorSentences, SayWhichWayHomeIsFound) {
  EXPECT_NE(said(RequestResult::NoProcedure, HomingMethod::HandPlaced).sentence.find("by hand"), std::string::npos);
  EXPECT_NE(said(RequestResult::NoProcedure, HomingMethod::Switch).sentence.find("another"), std::string::npos);
}

TEST(OperatorSentences, SayWhyGuidingEndsEachReasonInItsOwnWords) {
  std::set<std::string> sentences;
  for (int i = 0; i <= static_cast<int>(GuideStop::Silent); ++i)
    EXPECT_TRUE(sentences.insert(sentenceOf(static_cast<GuideStop>(i))).second);
  EXPECT_STREQ(sentenceOf(GuideStop::None), "");
  EXPECT_EQ(sentences.count("?"), 0u);
}

}  // namespace
}  // namespace knee_robot::control
