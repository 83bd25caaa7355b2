#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "knee_robot/base/files.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/tracing/trace.h"

namespace knee_robot::tracing {
namespace {

const std::string kRecording = std::string(KNEE_SOURCE_DIR) + "/../shared/data/measured/BENCH_V_17_12_2020_125008.csv";

/// The first actuator of the laboratory's bench.
mechanism::Robot oneAxis() {
  const std::string path = testing::TempDir() + "one_axis.yaml";
  writeFileAtomically(path,
                      "mechanism: axes\nactuators:\n"
                      "  - {position_min_m: -0.005, position_max_m: 0.30, velocity_max_m_per_s: 0.3, "
                      "acceleration_max_m_per_s2: 5.0, screw_lead_m: 0.020, counts_per_revolution: 1000, "
                      "encoder_sign: 1, home_length_m: 0.0, force_per_volt_N: 28.4628, force_sign: 1, "
                      "voltage_max_V: 9.5}\n");
  return mechanism::loadRobot(path);
}

// Mass, friction and offset of an axis alone are free: a factor of its force is what they do together. Named beside a
// ripple, the factor and those went away together: the error of the recording that was fitted rose from 5 to 38 N.
TEST(AbsorbedEffect, WhatTheBaselineOfAnAxisAloneDoesIsNotNamed) {
  if (!std::filesystem::exists(kRecording)) GTEST_SKIP() << kRecording << " is not there";
  const mechanism::Robot robot = oneAxis();
  recording::Recording recording = recording::loadRecording(kRecording);
  recording.axes = 1;
  for (Eigen::MatrixXd* columns :
       {&recording.reference_m, &recording.position_m, &recording.command_V, &recording.force_N}) {
    if (columns->cols() > 1) *columns = columns->leftCols(1).eval();
  }
  TraceOptions options;
  options.fast_band = false;
  options.observation.setCutoff(1.17);
  const TraceResult result = trace(
      robot, {recording},
      {identification::observe(robot, identification::columnsOf(robot), recording, options.observation)}, options);
  EXPECT_LE(result.after_rms_N[0], 1.01 * result.before_rms_N[0]);
  for (const std::string name : {"force_gain", "force_offset"}) {
    EXPECT_TRUE(std::any_of(result.absorbed.begin(), result.absorbed.end(),
                            [&](const std::string& sentence) { return sentence.rfind(name + ":", 0) == 0; }))
        << name << " is not said to be absorbed";
  }
  for (const FoundEffect& e : result.effects) {
    const std::string name = e.hypothesis.place.candidate->name();
    EXPECT_TRUE(name != "force_gain" && name != "force_offset" && name != "load_dependent_viscous") << name;
  }
}

}  // namespace
}  // namespace knee_robot::tracing
