#include "knee_robot/recording/markers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "knee_robot/base/errors.h"

namespace knee_robot::recording {
namespace {

constexpr const char* kMarkerMap =
    "time: {from: T, unit: s}\nunit: mm\ntolerance_mm: 3\nmarkers:\n"
    "  - {columns: [ax, ay, az], platform_m: [-0.30, 0.00, 0.02]}\n"
    "  - {columns: [bx, by, bz], platform_m: [0.10, 0.25, 0.02]}\n"
    "  - {columns: [cx, cy, cz], platform_m: [0.12, -0.20, 0.05]}\n"
    "  - {columns: [dx, dy, dz], platform_m: [0.30, 0.05, 0.00]}\n";

Eigen::Isometry3d platformAt(int row) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = (Eigen::AngleAxisd(0.01 * row, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(0.3 - 0.005 * row, Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  pose.translation() << 0.5, -0.2, 0.8 + 0.001 * row;
  return pose;
}

using Change = std::function<void(int row, Eigen::Matrix3Xd& markers)>;

/// An export of 60 rows in mm with 0.2 mm noise; `change` may spoil markers (m).
std::string exported(const Change& change) {
  const MarkerMap map = parseMarkerMap(kMarkerMap, "map");
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 2e-4);
  std::string text = "T\tax\tay\taz\tbx\tby\tbz\tcx\tcy\tcz\tdx\tdy\tdz\n";
  for (int row = 0; row < 60; ++row) {
    Eigen::Matrix3Xd at(3, 4);
    for (int m = 0; m < 4; ++m) {
      at.col(m) = platformAt(row) * map.markers[static_cast<std::size_t>(m)].platform_m;
      for (int k = 0; k < 3; ++k)
        at(k, m) += noise(random);
    }
    change(row, at);
    text += std::to_string(5.0 + 0.01 * row);
    for (int m = 0; m < 4; ++m) {
      for (int k = 0; k < 3; ++k)
        text += std::isnan(at(k, m)) ? std::string("\t") : "\t" + std::to_string(1e3 * at(k, m));
    }
    text += "\n";
  }
  return text;
}

MarkerPoses fitted(const Change& change) {
  const MarkerMap map = parseMarkerMap(kMarkerMap, "map");
  return fitMarkers(TextTable(exported(change), "capture.tsv", map.format), map);
}

double worstError(const MarkerPoses& poses) {
  double worst = 0.0;
  for (int row = 0; row < 60; ++row) {
    if (!poses.known[static_cast<std::size_t>(row)]) continue;
    const Eigen::Isometry3d error = platformAt(row).inverse() * poses.pose[static_cast<std::size_t>(row)];
    worst = std::max(worst, error.translation().norm() + 0.3 * Eigen::AngleAxisd(error.linear()).angle());
  }
  return worst;
}

TEST(Markers, BecomeThePlatformsPoseWithinTheirNoise) {
  const MarkerPoses poses = fitted([](int, Eigen::Matrix3Xd&) {});
  EXPECT_EQ(poses.gaps + poses.swapped + poses.dropped + poses.refused, 0);
  EXPECT_LT(worstError(poses), 1e-3);
  EXPECT_GT(poses.rms_m, 1e-4);
  EXPECT_LT(poses.rms_m, 4e-4);
  EXPECT_DOUBLE_EQ(poses.time_s.front(), 5.0);
}

TEST(Markers, ExchangedNamesArePutRightAndCounted) {
  const MarkerPoses poses = fitted([](int row, Eigen::Matrix3Xd& m) {
    if (row >= 10 && row < 25) m.col(1).swap(m.col(2));
  });
  EXPECT_EQ(poses.swapped, 15);
  EXPECT_LT(worstError(poses), 1e-3);
}

TEST(Markers, AWrongMarkerIsLeftOutWhenTheOthersAgree) {
  const MarkerPoses poses = fitted([](int row, Eigen::Matrix3Xd& m) {
    if (row == 7) m.col(3) += Eigen::Vector3d(0.1, 0.05, 0.0);
  });
  EXPECT_EQ(poses.dropped, 1);
  EXPECT_LT(worstError(poses), 2e-3);
}

TEST(Markers, RowsWithFewerThanThreeMarkersAreGapsAndZerosAreNotSeen) {
  const MarkerPoses poses = fitted([](int row, Eigen::Matrix3Xd& m) {
    if (row == 3) m.leftCols(2).setConstant(std::nan(""));
    if (row == 4) m.rightCols(2).setZero();
    if (row == 5) m.col(0).setZero();  // three are left
  });
  EXPECT_EQ(poses.gaps, 2);
  EXPECT_FALSE(poses.known[3]);
  EXPECT_FALSE(poses.known[4]);
  EXPECT_TRUE(poses.known[5]);
  EXPECT_LT(worstError(poses), 2e-3);
}

TEST(Markers, OfAnotherBodyAreRefused) {
  EXPECT_THROW(fitted([](int row, Eigen::Matrix3Xd& m) { m.col(0) *= 1.5 + 0.01 * row, m.col(1) *= 0.7; }), Refusal);
}

TEST(Markers, MapsWithoutThreeMarkersOffALineOrWithUnknownKeysAreRefusedByLine) {
  const std::string head = "rate_hz: 100\nunit: m\nmarkers:\n";
  EXPECT_THROW(parseMarkerMap(head + "  - {columns: [a, b, c], platform_m: [0, 0, 0]}\n", "map.yaml"), InputError);
  EXPECT_THROW(parseMarkerMap(head + "  - {columns: [a, b, c], platform_m: [0, 0, 0]}\n"
                                     "  - {columns: [d, e, f], platform_m: [1, 0, 0]}\n"
                                     "  - {columns: [g, h, i], platform_m: [2, 0, 0]}\n",
                              "map.yaml"),
               InputError);
  try {
    parseMarkerMap(std::string(kMarkerMap) + "colour: red\n", "map.yaml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("map.yaml"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("colour"), std::string::npos);
  }
}

TEST(Markers, CameraColumnsAreAddedOnceAndKeepTheRecordingAsItWas) {
  const std::string csv = "time_s,position_1_m,force_1_N\r\n0,0.5,1\r\n0.01,0.6,2\r\n";
  Eigen::MatrixXd camera(2, 4);
  camera << 0.1, 0.2, 0.3, 0.4, std::nan(""), std::nan(""), std::nan(""), std::nan("");
  const std::string with = withCameraColumns(csv, "run.csv", camera);
  EXPECT_EQ(with,
            "time_s,position_1_m,force_1_N,mocap_x_m,mocap_z_m,mocap_theta_rad,mocap_psi_rad\n"
            "0,0.5,1,0.1,0.2,0.3,0.4\n0.01,0.6,2,nan,nan,nan,nan\n");
  EXPECT_THROW(withCameraColumns(with, "run.csv", camera), InputError);
}

}  // namespace
}  // namespace knee_robot::recording
