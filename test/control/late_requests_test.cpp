// Whoever has heard that there is no answer can rely on it: nothing begins later.
#include <functional>
#include <utility>

#include "../../src/control/controller_parts.h"
#include "system_rig.h"

namespace knee_robot::control {
namespace {

TEST(LateRequests, DoNothingWhenTheProcessStoodStillBetweenTheQuestionAndTheCycle) {
  fake::Rig rig;
  ASSERT_TRUE(rig.system.start().ok);
  bool stands_still = true;
  rig.system.setPlant([&](rt::Nanoseconds time) {
    rig.machine.advanceTo(rt::toSeconds(time));
    if (stands_still) rig.system.pause(1.0);
    stands_still = false;
  });
  const Answer answer = rig.system.enable();
  EXPECT_FALSE(answer.ok);
  EXPECT_NE(answer.sentence.find("too late"), std::string::npos) << answer.sentence;
  for (int k = 0; k < 1000; ++k) {
    rig.system.step();
    ASSERT_EQ(rig.system.state(), MachineState::Disabled);
  }
  EXPECT_TRUE(rig.system.enable().ok) << "asked again";
}

/// What the facade hides: the controller's parts on the fake machine.
class PartsOnTheirOwn : public ::testing::Test {
 protected:
  PartsOnTheirOwn() {
    parts.runner.setPlant([this](rt::Nanoseconds time) {
      machine.advanceTo(rt::toSeconds(time));
      if (meanwhile) std::exchange(meanwhile, nullptr)();
    });
    parts.deployment->start();
    parts.started = true;
    parts.runner.run(0.1);
  }
  ~PartsOnTheirOwn() override { parts.deployment->stop(); }
  static ControlSystem::Options stepped() {
    ControlSystem::Options options;
    options.execution = rt::Execution::Stepped;
    return options;
  }

  fake::Machine machine{fake::robot()};
  std::function<void()> meanwhile;  // once, before the next cycle
  ControllerParts parts{fake::robot(), fake::hardware(), fake::deploymentFile(), machine, stepped()};
};

TEST_F(PartsOnTheirOwn, EndWhatWasAskedForWhereTheAnswerTookTooLong) {
  const Answer answer = parts.requests.make(RequestKind::Enable, 0.1);
  EXPECT_EQ(answer.sentence, "no answer within 0.1 s; the robot is enabling; what was asked for is taken back");
  parts.runner.run(5.0);
  EXPECT_EQ(parts.report.state(), MachineState::Disabled);
  EXPECT_TRUE(parts.requests.make(RequestKind::Enable, 5.0).ok);
  EXPECT_EQ(parts.report.state(), MachineState::Holding);
}

TEST_F(PartsOnTheirOwn, SayWhyWhereTheSupervisorFailsBeforeItAnswers) {
  meanwhile = [this] { static_cast<rt::TaskContext&>(*parts.machine.supervisor).stop(); };
  const Answer answer = parts.requests.make(RequestKind::Enable, 5.0);
  EXPECT_FALSE(answer.ok);
  EXPECT_EQ(answer.sentence.find("no answer within"), std::string::npos) << answer.sentence;
  EXPECT_NE(answer.sentence.find(describe(Fault::ComponentException).sentence), std::string::npos) << answer.sentence;
}

TEST_F(PartsOnTheirOwn, TakeUpWhatIsAskedForAfterAPause) {
  parts.runner.pause(1.0);
  const Answer answer = parts.requests.make(RequestKind::Enable, 5.0);
  EXPECT_TRUE(answer.ok) << answer.sentence;
}

TEST_F(PartsOnTheirOwn, PlayNothingThatAStopHasOvertakenWhoeverAskedForIt) {
  ASSERT_TRUE(parts.requests.make(RequestKind::Enable, 5.0).ok);
  parts.runner.run(2.0);
  ASSERT_TRUE(parts.player.load(parts.player.check(fake::smoothReference(fake::kHome, 0.03, 2.0)), {}).ok);
  for (const bool approach : {false, true}) {
    meanwhile = [this] { parts.player.halt(); };  // stop() says this first, and its request comes later
    const Answer answer = approach ? parts.player.approach(0.01, {}) : parts.player.play();
    EXPECT_FALSE(answer.ok) << answer.sentence;
    parts.runner.run(3.0);
    EXPECT_EQ(parts.report.state(), MachineState::Holding);
    EXPECT_NEAR(parts.panel.row()->reference_m[0], fake::kHome, 0.001);
  }
  EXPECT_TRUE(parts.player.play().ok) << "asked for after it";
}

}  // namespace
}  // namespace knee_robot::control
