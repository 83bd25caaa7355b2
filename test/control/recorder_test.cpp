#include "src/control/recorder.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "knee_robot/base/files.h"
#include "knee_robot/recording/recording.h"
#include "src/control/recording_drain.h"
#include "system_rig.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using fake::Rig;

class RecorderTest : public ::testing::Test {
 protected:
  std::string path() const { return folder_ + "/r.csv"; }
  const TemporaryFolder folder_;
};

TEST_F(RecorderTest, WritesEveryCycleOfAMotionAsTheMachineGotIt) {
  Rig rig;
  rig.hold();
  ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome, 0.02, 1.0)).ok);
  ASSERT_TRUE(rig.system.startRecording(path()).ok);
  EXPECT_FALSE(rig.system.startRecording(path()).ok) << "one at a time";
  rig.machine.events.clear();
  ASSERT_TRUE(rig.system.play().ok);
  ASSERT_TRUE(rig.system.waitFor(MachineState::Playing, 1.0));
  ASSERT_TRUE(rig.system.waitFor(MachineState::Holding, 2.0));
  const Answer answer = rig.system.stopRecording();
  EXPECT_TRUE(answer.ok) << answer.sentence;
  const recording::Recording recording = recording::loadRecording(path());
  ASSERT_EQ(static_cast<std::size_t>(recording.rows()), rig.machine.events.size()) << "one row a cycle";
  ASSERT_GT(recording.rows(), 1000);
  const mechanism::Robot robot = fake::robot();
  for (int row = 0; row < recording.rows(); ++row) {
    const fake::Machine::Event& event = rig.machine.events[static_cast<std::size_t>(row)];
    EXPECT_NEAR(recording.time_s[static_cast<std::size_t>(row)], event.time_s, 1e-6);
    for (int i = 0; i < hardware::kAxes; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const double signed_gain = robot.actuators[axis].force_sign * robot.actuators[axis].force_per_volt_N;
      EXPECT_NEAR(recording.command_V(row, i), event.volts[axis], 1e-6);
      EXPECT_NEAR(recording.force_N(row, i), signed_gain * event.volts[axis], 1e-3);
    }
  }
  std::vector<double> gains;
  for (const mechanism::Actuator& actuator : robot.actuators)
    gains.push_back(actuator.force_sign * actuator.force_per_volt_N);
  EXPECT_NO_THROW(recording::commandedForce(recording, gains)) << "force and volts agree";
  EXPECT_NEAR(recording.reference_m(recording.rows() - 1, 2), fake::kHome + 0.02, 1e-6);
}

TEST_F(RecorderTest, NeverOverwritesARecording) {
  Rig rig;
  rig.hold();
  writeFileAtomically(path(), "old");
  const Answer answer = rig.system.startRecording(path());
  EXPECT_FALSE(answer.ok);
  EXPECT_NE(answer.sentence.find(path()), std::string::npos);
  EXPECT_EQ(readFile(path()), "old");
}

TEST_F(RecorderTest, IsReadableAtAnyMomentBeforeItIsClosed) {
  Rig rig;
  rig.hold();
  ASSERT_TRUE(rig.system.startRecording(path()).ok);
  rig.system.run(1.0);
  const recording::Recording recording = recording::loadRecording(path());  // as after a kill: nothing was closed
  EXPECT_GE(recording.rows(), 900);
  EXPECT_EQ(rig.system.status().recording, path());
}

/// A Recorder fed by hand, without anybody draining it.
struct RecorderFeed : rt::TaskContext {
  RecorderFeed() : rt::TaskContext("RecorderFeed") {}
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", ""};
};

TEST_F(RecorderTest, WritesTheResidualAndWhichEncodersAreAsked) {
  struct Observed : RecorderFeed {
    rt::OutputPort<Disturbance> disturbance{*this, "disturbance", ""};
    rt::OutputPort<AxisCommand> command{*this, "command", ""};
  } feed;
  Recorder recorder("Recorder");
  rt::connect(feed.measurement, recorder.measurement);
  rt::connect(feed.disturbance, recorder.disturbance);
  rt::connect(feed.command, recorder.command_3);
  ASSERT_TRUE(recorder.configure());
  ASSERT_TRUE(recorder.start());
  RecordingDrain drain(recorder, 4, false);
  drain.start(path());
  rt::Cycle cycle;
  cycle.period = 1'000'000;
  for (std::uint64_t n = 1; n <= 2; ++n) {
    AxesMeasurement measurement;
    measurement.sequence = n;
    measurement.status = hardware::IoStatus::Ok;
    cycle.time = measurement.read_at = static_cast<rt::Nanoseconds>(n) * cycle.period;
    Disturbance disturbance;
    disturbance.identified = true;
    disturbance.known = n == 2;
    disturbance.residual_N = {1.0, -2.5, 3.0, 4.0};
    AxisCommand command;
    command.pulse_N = n == 2 ? 80.0 : 0.0;
    feed.measurement.write(measurement);
    feed.disturbance.write(disturbance);
    feed.command.write(command);
    recorder.update(cycle);
  }
  drain.stop();
  const std::string text = readFile(path());
  EXPECT_NE(text.find("residual_2_N"), std::string::npos);
  EXPECT_NE(text.find(",nan,"), std::string::npos) << "not known in the first row";
  EXPECT_NE(text.find(",-2.5000,"), std::string::npos) << text;
  const recording::Recording read = recording::loadRecording(path());
  ASSERT_EQ(read.test_pulse.size(), 2);
  EXPECT_EQ(read.test_pulse[0], 0.0);
  EXPECT_EQ(read.test_pulse[1], 4.0) << "axis 3";
}

TEST_F(RecorderTest, CountsRowsThatTheRingCouldNotTakeAndSaysSo) {
  RecorderFeed feed;
  Recorder recorder("Recorder");
  rt::connect(feed.measurement, recorder.measurement);
  ASSERT_TRUE(recorder.configure());
  ASSERT_TRUE(recorder.start());
  RecordingDrain drain(recorder, 4, false);
  drain.start(path());
  constexpr std::uint64_t kRows = Recorder::kRingRows + 100;
  rt::Cycle cycle;
  cycle.period = 1'000'000;
  const auto feedRows = [&](std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t n = from; n <= to; ++n) {
      AxesMeasurement measurement;
      measurement.sequence = n;
      measurement.status = hardware::IoStatus::Ok;
      cycle.time = measurement.read_at = static_cast<rt::Nanoseconds>(n) * cycle.period;
      feed.measurement.write(measurement);
      recorder.update(cycle);
    }
  };
  feedRows(1, kRows);
  drain.drain();
  feedRows(kRows + 1, kRows + 10);
  const RecordingResult result = drain.stop();
  EXPECT_EQ(result.dropped, 100u);
  EXPECT_EQ(result.rows, kRows - 100 + 10);
  EXPECT_EQ(result.skipped, 0u);
  EXPECT_EQ(static_cast<std::uint64_t>(recording::loadRecording(path()).rows()), result.rows);
}

TEST_F(RecorderTest, WritesAnIdOfTheHomingThatTheReaderHandsOn) {
  RecorderFeed feed;
  Recorder recorder("Recorder");
  rt::connect(feed.measurement, recorder.measurement);
  ASSERT_TRUE(recorder.configure());
  ASSERT_TRUE(recorder.start());
  RecordingDrain drain(recorder, 4, false, 1'700'000'000);
  std::uint64_t row = 0;
  const auto record = [&](std::initializer_list<std::uint32_t> home_numbers) {
    std::filesystem::remove(path());
    drain.start(path());
    rt::Cycle cycle;
    cycle.period = 1'000'000;
    for (const std::uint32_t number : home_numbers) {
      AxesMeasurement measurement;
      measurement.sequence = ++row;
      measurement.status = hardware::IoStatus::Ok;
      measurement.home_number = number;
      cycle.time = measurement.read_at = static_cast<rt::Nanoseconds>(row) * cycle.period;
      feed.measurement.write(measurement);
      recorder.update(cycle);
    }
    drain.stop();
    return recording::loadRecording(path()).home_id;
  };
  EXPECT_EQ(record({0, 0, 0}), 1'700'000'000) << "incremental encoders: the start of the program is a homing";
  EXPECT_EQ(record({3, 3, 3}), 1'700'000'003);
  EXPECT_EQ(record({3, 4, 4}), 0) << "homed anew in between";
}

TEST_F(RecorderTest, TellsSkippedCyclesFromDroppedRows) {
  Rig rig;
  rig.hold();
  ASSERT_TRUE(rig.system.startRecording(path()).ok);
  rig.system.run(0.1);
  auto& servo = dynamic_cast<rt::SteppedActivity&>(*rig.system.deployment().activity("servo"));
  servo.skip(30);
  rig.system.run(0.1);
  EXPECT_EQ(rig.system.state(), MachineState::Holding) << "a pause of 30 ms is no fault";
  const Answer answer = rig.system.stopRecording();
  EXPECT_TRUE(answer.ok) << answer.sentence;
  EXPECT_NE(answer.sentence.find("skipped 30 cycles"), std::string::npos) << answer.sentence;
}

TEST_F(RecorderTest, SaysThatItsFileWasRemovedMeanwhileAndCountsNoRowsInIt) {
  Rig rig;
  rig.hold();
  ASSERT_TRUE(rig.system.startRecording(path()).ok);
  rig.system.run(0.1);
  std::filesystem::remove(path());
  rig.system.run(0.1);
  const Answer answer = rig.system.stopRecording();
  EXPECT_FALSE(answer.ok);
  EXPECT_EQ(answer.sentence.find("the recording is incomplete: " + path() + ": was removed"), 0u) << answer.sentence;
  EXPECT_EQ(answer.sentence.find(path() + " has "), std::string::npos) << answer.sentence;
}

}  // namespace
}  // namespace knee_robot::control
