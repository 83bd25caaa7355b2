#include "knee_robot/tracing/pose_trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "knee_robot/simulation/camera.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::tracing {
namespace {

/// Encoders along sines of the pose, 100 rows a second, with stops; lengths in whole counts. `only`: one coordinate
/// moves, -1: all.
recording::Recording sines(const mechanism::Robot& robot, int variant, double seconds, int only = -1) {
  const double center[] = {0.02, 0.78, 0.05, 0.0}, amplitude[] = {0.05, 0.06, 0.14, 0.12};
  const double hz[] = {0.11, 0.09, 0.13, 0.10}, f = 1.0 + 0.23 * variant, p = 0.9 * variant;
  recording::Recording r;
  r.path = r.name = "sines_" + std::to_string(variant);
  r.axes = 4;
  const auto rows = static_cast<Eigen::Index>(100.0 * seconds);
  r.position_m.resize(rows, 4);
  r.force_N = Eigen::MatrixXd::Constant(rows, 4, 100.0);
  for (Eigen::Index n = 0; n < rows; ++n) {
    const double t = 0.01 * static_cast<double>(n);
    r.time_s.push_back(t);
    const double moved = t - 0.35 * std::sin(2.0 * M_PI * t / 2.2);  // nearly stops every 2.2 s
    mechanism::Pose pose;
    for (int i = 0; i < 4; ++i) {
      const double w = 2.0 * M_PI * hz[i] * f;
      const double size = only < 0 || only == i ? amplitude[i] : 0.0;
      pose[i] = center[i] + size * (0.75 * std::sin(w * moved + p + i) + 0.25 * std::sin(2.7 * w * moved + 2 * p));
    }
    const mechanism::Lengths lengths = mechanism::legLengths(*robot.mechanism, pose);
    for (int i = 0; i < 4; ++i) {
      const double count = robot.actuators[static_cast<std::size_t>(i)].metresPerCount();
      r.position_m(n, i) = count * std::round(lengths[i] / count);
    }
  }
  return r;
}

struct Traced {
  PoseTrace trace;
  std::string found;
};

/// Trained on the first `training` of that many and one more recordings of 60 s.
Traced traceCamera(
    const simulation::CameraSimulation& camera,
    const std::function<void(mechanism::Geometry&)>& change = [](mechanism::Geometry&) {}, int training = 1) {
  const mechanism::Robot robot = mechanism::configuredRobot("B");
  mechanism::Geometry geometry = robot.mechanism->geometry;
  change(geometry);
  std::vector<recording::Recording> recordings;
  for (int variant = 1; variant <= training + 1; ++variant) {
    recordings.push_back(sines(robot, variant, 60.0));
    simulation::CameraSimulation each = camera;
    each.seed += static_cast<unsigned>(variant);
    each.rotation_rad = 0.03;
    each.shift_x_m = 0.4;
    each.shift_z_m = -0.2;
    each.plate_rad = -0.05;
    each.delay_s = 0.04;
    simulation::addCamera(geometry, each, recordings.back());
  }
  Traced t;
  t.trace = tracePose(robot, {recordings.begin(), recordings.end() - 1}, {recordings.back()}, {});
  for (const PoseFinding& f : t.trace.findings) {
    t.found += textOf(f.hypothesis) + " = " + std::to_string(f.value) + " +- " + std::to_string(f.std) + " p " +
               std::to_string(f.p) + ", not told from";
    for (const PoseHypothesis& other : f.confusable)
      t.found += " [" + textOf(other) + "]";
    t.found += "\n";
  }
  for (const std::string& sentence : t.trace.rejected)
    t.found += "rejected: " + sentence + "\n";
  for (const std::string& sentence : t.trace.notes)
    t.found += "note: " + sentence + "\n";
  return t;
}

bool found(const Traced& t, const PoseHypothesis& h) {
  for (const PoseFinding& f : t.trace.findings) {
    if (f.hypothesis == h) return true;
  }
  return false;
}

/// KNEE_CLEAN_CAMERAS=50 for a longer look.
TEST(PoseTrace, LeavesCleanCamerasAlone) {
  const char* wanted = std::getenv("KNEE_CLEAN_CAMERAS");
  const unsigned count = wanted ? static_cast<unsigned>(std::atoi(wanted)) : 4u;
  for (unsigned seed = 1; seed <= count; ++seed) {
    simulation::CameraSimulation camera;
    camera.seed = 100 * seed;
    camera.missing_share = 0.05;
    const Traced t = traceCamera(camera);
    ASSERT_TRUE(t.trace.available) << t.trace.reason;
    EXPECT_TRUE(t.trace.findings.empty()) << t.found;
  }
}

TEST(PoseTrace, FindsTheFrameAndTheNoiseOfACleanCamera) {
  const Traced t = traceCamera({});
  // Noise 0.2 mm and 1 mrad; rms of what is left is that, here through straight lines between pictures.
  EXPECT_NEAR(t.trace.noise[0], 2e-4, 4e-5);
  EXPECT_NEAR(t.trace.noise[3], 1e-3, 2e-4);
  EXPECT_LT(t.trace.validate[0].before.rms[0], 3e-4);
  EXPECT_LT(t.trace.validate[0].before.rms[3], 1.5e-3);
  EXPECT_NEAR(t.trace.before.rotation_rad, -0.03, 2e-3);
}

TEST(PoseTrace, NamesAHomeOffsetAndRemovesItsErrorElsewhere) {
  simulation::CameraSimulation camera;
  camera.home_offset_m = {0.0, 0.004, 0.0, 0.0};
  const Traced t = traceCamera(
      camera, [](mechanism::Geometry&) {}, 2);
  ASSERT_EQ(t.trace.findings.size(), 1u) << t.found;
  ASSERT_TRUE(found(t, {PoseCause::HomeOffset, 1})) << t.found;
  EXPECT_NEAR(t.trace.findings[0].value, 0.004, 4e-4);
  const PoseRecording& other = t.trace.validate[0];
  EXPECT_GT(other.after.rows, 1000);
  EXPECT_GT(other.before.rms.cwiseQuotient(t.trace.noise).maxCoeff(), 2.0) << "it must matter elsewhere";
  EXPECT_LT(other.after.rms.cwiseQuotient(t.trace.noise).maxCoeff(), 1.3);
}

TEST(PoseTrace, DoesNotExpectTheHomeOffsetOfOneRecordingElsewhere) {
  simulation::CameraSimulation camera;
  camera.home_offset_m = {0.0, 0.004, 0.0, 0.0};
  const Traced t = traceCamera(camera);
  ASSERT_EQ(t.trace.findings.size(), 1u) << t.found;
  EXPECT_FALSE(t.trace.findings[0].transfers);
  EXPECT_LT(t.trace.train[0].after.rms.cwiseQuotient(t.trace.noise).maxCoeff(), 1.2);
  EXPECT_GT(t.trace.validate[0].after.rms.cwiseQuotient(t.trace.noise).maxCoeff(), 1.5);
}

TEST(PoseTrace, NamesADimensionThatIsWrong) {
  const Traced t = traceCamera({}, [](mechanism::Geometry& g) { g.Rm[1] += 0.006; });
  ASSERT_FALSE(t.trace.findings.empty()) << t.found;
  ASSERT_TRUE(found(t, {PoseCause::GeometryError, 7})) << t.found;
  EXPECT_NEAR(t.trace.findings[0].value, 0.006, 1e-3) << t.found;
  const PoseRecording& other = t.trace.validate[0];
  EXPECT_LT(other.after.rms[3], 1.2 * 1.0e-3) << t.found;
}

TEST(PoseTrace, NamesThePlayOfALeg) {
  simulation::CameraSimulation camera;
  camera.half_play_m = {0.0, 0.0, 0.0015, 0.0};
  const Traced t = traceCamera(camera);
  ASSERT_FALSE(t.trace.findings.empty()) << t.found;
  ASSERT_TRUE(found(t, {PoseCause::TravelClearance, 2})) << t.found;
  EXPECT_NEAR(t.trace.findings[0].value, 0.0015, 3e-4) << t.found;
  const PoseRecording& other = t.trace.validate[0];
  EXPECT_LT(other.after.rms[3], 0.8 * other.before.rms[3]) << t.found;
}

/// Along Xm alone a larger radius of leg 1 at the base does what a smaller one at the platform does.
TEST(PoseTrace, ReportsWhatTheMovementCannotTellApartTogether) {
  const mechanism::Robot robot = mechanism::configuredRobot("B");
  recording::Recording r = sines(robot, 1, 40.0, 0);
  mechanism::Geometry geometry = robot.mechanism->geometry;
  geometry.R[0] += 0.006;
  simulation::addCamera(geometry, {}, r);
  const PoseTrace trace = tracePose(robot, {r}, {}, {});
  ASSERT_EQ(trace.findings.size(), 1u);
  ASSERT_EQ(trace.findings[0].confusable.size(), 1u);
  std::vector<std::string> names = {parameterOf(trace.findings[0].hypothesis),
                                    parameterOf(trace.findings[0].confusable[0])};
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"R_1_m", "Rm_1_m"}));
}

/// Every offset, dimension and play once, strong enough to matter; prints what was named.
TEST(PoseTrace, NamesWhatMattersExactlyOrWithItsRivals) {
  int material = 0, exact = 0, among_rivals = 0, extra = 0;
  for (int k = 0; k < 19; ++k) {
    simulation::CameraSimulation camera;
    camera.seed = static_cast<unsigned>(1000 + k);
    PoseHypothesis truth{k < 4   ? PoseCause::HomeOffset
                         : k < 8 ? PoseCause::TravelClearance
                                 : PoseCause::GeometryError,
                         k < 8 ? k % 4 : k - 8};
    if (k < 4) camera.home_offset_m[static_cast<std::size_t>(k)] = 0.005;
    if (k >= 4 && k < 8) camera.half_play_m[static_cast<std::size_t>(k - 4)] = 0.0015;
    const Traced t = traceCamera(
        camera,
        [&](mechanism::Geometry& g) {
          double* const dimensions[] = {&g.R[0],  &g.R[1],  &g.R[2],  &g.ds,      &g.beta_FD, &g.beta_FI,
                                        &g.Rm[0], &g.Rm[1], &g.Rm[2], &g.beta_MD, &g.beta_MI};
          if (k >= 8) *dimensions[truth.index] += 0.008;
        },
        k < 4 ? 2 : 1);
    const PoseErrors &before = t.trace.validate[0].before, &after = t.trace.validate[0].after;
    ASSERT_GT(before.rows, 1000) << t.found;
    const double was = before.rms.cwiseQuotient(t.trace.noise).maxCoeff(),
                 is = after.rms.cwiseQuotient(t.trace.noise).maxCoeff();
    const bool matters = was > 1.5;
    bool named = false, rival = false;
    std::string what;
    for (const PoseFinding& f : t.trace.findings) {
      const bool here = f.hypothesis == truth;
      const bool beside = std::find(f.confusable.begin(), f.confusable.end(), truth) != f.confusable.end();
      named = named || here;
      rival = rival || beside;
      what += "  " + textOf(f.hypothesis) + (beside ? " (or the truth)" : "");
      if (matters && !here && !beside) ++extra;
    }
    material += matters;
    exact += matters && named;
    among_rivals += matters && !named && rival;
    std::printf("%-45s error / noise elsewhere %5.1f -> %4.1f%s\n", textOf(truth).c_str(), was, is, what.c_str());
  }
  std::printf("material %d, exact %d, among rivals %d, wrong beside %d\n", material, exact, among_rivals, extra);
  EXPECT_GE(material, 8);
  EXPECT_GE(exact + among_rivals, (9 * material + 9) / 10);
  EXPECT_LE(extra, material / 5);
}

TEST(PoseTrace, SaysWhenThereIsNoCamera) {
  const mechanism::Robot robot = mechanism::configuredRobot("B");
  const PoseTrace t = tracePose(robot, {sines(robot, 1, 10.0)}, {}, {});
  EXPECT_FALSE(t.available);
  EXPECT_EQ(t.reason, "no training recording has enough camera poses");
}

TEST(PoseTrace, DoesNotLoseItselfInTheOtherAssemblyModeOfARecording) {
  const char* shared = std::getenv("KNEE_SHARED_DIR");
  const std::string file = (shared ? std::string(shared) : std::string(KNEE_SOURCE_DIR) + "/../shared") +
                           "/data/measured/A_V_22_03_2021_155607.csv";
  if (!std::ifstream(file)) GTEST_SKIP() << file << " is not here";
  const mechanism::Robot robot = mechanism::configuredRobot("A");
  const PoseTrace t = tracePose(robot, {recording::loadRecording(file)}, {}, {});
  ASSERT_TRUE(t.available);
  EXPECT_GT(t.train[0].other_solution, 100);  // 25.3 to 27.8 s
  for (Eigen::Index n = 0; n < t.train[0].after_error.rows(); ++n) {
    const double time = t.train[0].time_s[static_cast<std::size_t>(n)];
    ASSERT_TRUE(std::isfinite(time));
  }
  for (int k = 0; k < 2; ++k)
    EXPECT_LT(t.train[0].after.rms[k], 0.02);
}

}  // namespace
}  // namespace knee_robot::tracing
