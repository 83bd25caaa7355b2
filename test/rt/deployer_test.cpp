#include "knee_robot/rt/deployer.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"
#include "test/temporary_folder.h"

namespace knee_robot::rt {
namespace {

std::vector<std::string> log_of_starts;

class Source : public TaskContext {
 public:
  explicit Source(const std::string& name) : TaskContext(name) {}
  OutputPort<double> value{*this, "value", "what it counts"};
  Property<double> step{*this, "step", 1.0, "m", 0.0, 10.0, "increment of a cycle"};
  Property<bool> refuses{*this, "refuses", false, "does not start"};

 protected:
  bool startHook() override {
    log_of_starts.push_back("start " + name());
    return !refuses || refuse("told to refuse");
  }
  void updateHook(const Cycle&) override { value.write(sum_ += step); }
  void stopHook() override { log_of_starts.push_back("stop " + name()); }

 private:
  double sum_ = 0.0;
};

class Sink : public TaskContext {
 public:
  explicit Sink(const std::string& name) : TaskContext(name) {}
  InputPort<double> value{*this, "value", "what it keeps"};
  InputPort<int> other{*this, "other", "not needed", Need::Optional};
  double last = 0.0;

 protected:
  bool startHook() override {
    log_of_starts.push_back("start " + name());
    return true;
  }
  void updateHook(const Cycle&) override { value.read(last); }
  void stopHook() override { log_of_starts.push_back("stop " + name()); }
};

class Pair : public TaskContext {
 public:
  explicit Pair(const std::string& name) : TaskContext(name) {}
  InputPort<double> value_1{*this, "value_1", "of the first"}, value_2{*this, "value_2", "of the second"};
  double first = 0.0, second = 0.0;

 protected:
  void updateHook(const Cycle&) override {
    value_1.read(first);
    value_2.read(second);
  }
};

TypeFactory factory() {
  return {{"Source", [](const std::string& name) { return std::make_unique<Source>(name); }},
          {"Sink", [](const std::string& name) { return std::make_unique<Sink>(name); }},
          {"Pair", [](const std::string& name) { return std::make_unique<Pair>(name); }}};
}

const char* const kGood = R"(activities:
  - {name: servo, period_s: 0.001}
components:
  - {name: S, type: Source, activity: servo, period_s: 0.002, properties: {step: 2.5}}
  - {name: K, type: Sink, activity: servo}
connections:
  - {from: S.value, to: K.value}
start_order: [K, S]
)";

class DeployerTest : public ::testing::Test {
 protected:
  void SetUp() override { log_of_starts.clear(); }
  std::string path() const { return folder_ + "/d.yaml"; }
  std::string with(const std::string& from, const std::string& to) const {
    std::string text = kGood;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  std::string refusalOf(const std::string& text) {
    writeFileAtomically(path(), text);
    try {
      Deployment deployment(path(), factory(), Execution::Stepped);
      deployment.start();
    } catch (const InputError& error) {
      const std::string all = error.what();
      EXPECT_EQ(all.rfind(path() + ":", 0), 0u) << all;
      return all.substr(path().size() + 1);
    }
    return "";
  }
  const TemporaryFolder folder_;
};

TEST_F(DeployerTest, BuildsConnectsStartsInOrderAndStopsInReverse) {
  writeFileAtomically(path(), kGood);
  {
    Deployment deployment(path(), factory(), Execution::Stepped);
    deployment.start();
    deployment.stepUntil(5'000'000);
    EXPECT_DOUBLE_EQ(dynamic_cast<Sink&>(*deployment.component("K")).last, 3 * 2.5) << "updates at 0, 2 and 4 ms";
  }
  EXPECT_EQ(log_of_starts, (std::vector<std::string>{"start K", "start S", "stop S", "stop K"}));
}

TEST_F(DeployerTest, ConnectsByNameAndTypeWhatNoLineConnects) {
  writeFileAtomically(path(), with("connections:\n  - {from: S.value, to: K.value}\n", ""));
  Deployment deployment(path(), factory(), Execution::Stepped);
  deployment.start();
  deployment.stepUntil(5'000'000);
  const auto& sink = dynamic_cast<Sink&>(*deployment.component("K"));
  EXPECT_DOUBLE_EQ(sink.last, 3 * 2.5);
  EXPECT_FALSE(sink.other.isConnected()) << "optional, and nobody sends an int of that name";
}

TEST_F(DeployerTest, ConnectsANumberedInputToTheComponentOfThatNumber) {
  writeFileAtomically(path(), R"(activities: [{name: servo, period_s: 0.001}]
components:
  - {name: Source2, type: Source, activity: servo, properties: {step: 2}}
  - {name: Source1, type: Source, activity: servo, properties: {step: 1}}
  - {name: P, type: Pair, activity: servo}
start_order: [P, Source1, Source2]
)");
  Deployment deployment(path(), factory(), Execution::Stepped);
  deployment.start();
  deployment.stepUntil(1'000'000);
  const auto& pair = dynamic_cast<Pair&>(*deployment.component("P"));
  EXPECT_EQ((std::array<double, 2>{pair.first, pair.second}), (std::array<double, 2>{1.0, 2.0}));
}

TEST_F(DeployerTest, RefusesARequiredInputThatNobodyFeeds) {
  const std::string refusal = refusalOf(R"(activities: [{name: servo, period_s: 0.001}]
components: [{name: K, type: Sink, activity: servo}]
start_order: [K]
)");
  EXPECT_EQ(refusal.rfind("2: components: the input K.value (double) is not connected: no output has its name", 0), 0u)
      << refusal;
}

TEST_F(DeployerTest, RunsTheSameFileOnThreads) {
  writeFileAtomically(path(), kGood);
  Deployment deployment(path(), factory(), Execution::Threads);
  deployment.start();
  while (deployment.activity("servo")->statistics().cycles.load() < 20)
    sched_yield();
  deployment.stop();
  EXPECT_GT(dynamic_cast<Sink&>(*deployment.component("K")).last, 0.0);
  EXPECT_EQ(deployment.component("S")->state(), TaskState::Stopped);
}

TEST_F(DeployerTest, StopsWhatWasStartedWhenAComponentRefuses) {
  EXPECT_EQ(refusalOf(with("step: 2.5", "refuses: true")), " component S did not start: told to refuse");
  EXPECT_EQ(log_of_starts, (std::vector<std::string>{"start K", "start S", "stop K"}));
}

TEST_F(DeployerTest, RefusesWhatIsWrongByLineBeforeAnythingRuns) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {with("step: 2.5", "stride: 2.5"), "4: stride: component S has no such property; it has step, refuses"},
      {with("step: 2.5", "step: 25"), "4: step: 25 is outside 0 .. 10"},
      {with("type: Source", "type: Sauce"), "4: type: there is no component type Sauce; there are Pair, Sink, Source"},
      {with("activity: servo, period_s: 0.002", "activity: slow"),
       "4: activity: there is no activity slow; there are servo"},
      {with("period_s: 0.002", "period_s: 0.0015"),
       "4: period_s: component S has the period 0.0015 s, which is no whole"},
      {with("name: K", "name: S"), "5: name: there are two components named S; rename one"},
      {with("to: K.value", "to: K.other"), "7: from: S.value sends double, but K.other takes int"},
      {with("to: K.value", "to: K.valve"), "7: to: component K has no port valve; it has value, other"},
      {with("from: S.value", "from: T.value"), "7: from: there is no component T; there are S, K"},
      {with("  - {name: K, type: Sink, activity: servo}\nconnections:\n  - {from: S.value, to: K.value}",
            "  - {name: K, type: Sink, activity: servo}\n  - {name: T, type: Source, activity: servo}"),
       "4: components: the input K.value could be connected to S.value or T.value: say which under connections"},
      {with("type: Source, activity: servo, period_s: 0.002, properties: {step: 2.5}", "type: Sink, activity: servo"),
       "7: from: S"},
      {with("[K, S]", "[K]"), "8: start_order: S is missing"},
      {with("[K, S]", "[K, S, K]"), "8: start_order: K stands there twice"},
      {with("start_order", "strat_order"), "1: the key start_order is missing"},
      {with("start_order", "speed: 3\nstart_order"), "8: "},
  };
  for (const auto& [text, expected] : cases) {
    const std::string refusal = refusalOf(text);
    EXPECT_EQ(refusal.substr(0, expected.size()), expected) << refusal;
    EXPECT_TRUE(log_of_starts.empty());
  }
}

}  // namespace
}  // namespace knee_robot::rt
