#include "knee_robot/simulation/virtual_plant.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/effect_law.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/simulation/virtual_recording.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::simulation {
namespace {

constexpr double kPeriod_s = 0.01;

/// A motion of both configured geometries: sums of sines in the pose, from rest to rest, as actuator lengths.
class VirtualPlants : public testing::TestWithParam<const char*> {
 protected:
  VirtualPlants()
      : robot_(mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + GetParam() + ".yaml")),
        inertia_(dynamics::loadRobotInertia(robot_)),
        start_(poseAt(0.0)) {}

  const mechanism::Mechanism& mechanism() const { return *robot_.mechanism; }

  mechanism::Pose poseAt(double t) const {
    mechanism::Lengths home;
    for (int i = 0; i < mechanism::kLegs; ++i)
      home[i] = robot_.actuators[static_cast<std::size_t>(i)].home_length_m + 0.03;
    const mechanism::Pose centre = mechanism::forwardKinematicsFromHome(mechanism(), home).pose;
    const double s = t / kDuration_s, window = 64.0 * std::pow(s * (1.0 - s), 3);
    return centre + window * mechanism::Vector4(0.03 * std::sin(3.0 * t), 0.04 * std::sin(2.0 * t),
                                                0.10 * std::sin(2.5 * t), 0.15 * std::cos(4.0 * t));
  }
  AxisPath path() const {
    const Eigen::Index points = std::lround(kDuration_s / kPeriod_s) + 1;
    Eigen::Matrix<double, Eigen::Dynamic, mechanism::kLegs> lengths(points, mechanism::kLegs);
    for (Eigen::Index k = 0; k < points; ++k)
      lengths.row(k) = mechanism::legLengths(mechanism(), poseAt(static_cast<double>(k) * kPeriod_s)).transpose();
    return {lengths, kPeriod_s};
  }
  VirtualPlant plant(const VirtualPlantParameters& parameters) const {
    return {mechanism(), robot_.gravity, inertia_, start_, parameters};
  }
  /// The platform's motion that belongs to the actuators', by our own kinematics.
  mechanism::Motion motionOf(const AxisMotion& axes, mechanism::Pose& guess) const {
    mechanism::Motion motion;
    EXPECT_EQ(mechanism::motionFromLengths(mechanism(), axes.position, axes.velocity, axes.acceleration, guess, motion),
              mechanism::ForwardStatus::Converged);
    guess = motion.pose;
    return motion;
  }

  /// That what the actuators bring up more with `more` than with `less` friction is what a law of trace says, whose
  /// columns `on_pose` adds up.
  template <typename OnPose>
  void expectLaw(const char* name, const VirtualPlantParameters& more, const VirtualPlantParameters& less,
                 const OnPose& on_pose) {
    VirtualPlant rubbing = plant(more), without = plant(less);
    const auto law = dynamics::effectLaw(name, "", {1e-12});
    const AxisPath path_of_both = path();
    mechanism::Pose pose = start_;
    mechanism::RobotMotion robot;
    for (double t = 0.2; t < kDuration_s; t += 0.0137) {
      VirtualPlantOutput with_it, without_it;
      ASSERT_TRUE(rubbing.follow(path_of_both.at(t), with_it));
      ASSERT_TRUE(without.follow(path_of_both.at(t), without_it));
      const mechanism::Motion motion = motionOf(path_of_both.at(t), pose);
      mechanism::robotMotion(mechanism(), motion, robot);
      dynamics::PoseColumns columns;
      dynamics::EffectInstant at;
      dynamics::EffectState state;
      at.mechanism = &mechanism();
      at.motion = &motion;
      law->poseColumns(at, state, columns);
      const mechanism::Vector4 ours = robot.jacobian.transpose().partialPivLu().solve(on_pose(columns));
      ASSERT_LT((ours - (with_it.force - without_it.force)).norm(), 1e-6 * ours.norm()) << t;
    }
  }

  static constexpr double kDuration_s = 5.0;
  mechanism::Robot robot_;
  dynamics::RobotInertia inertia_;
  mechanism::Pose start_;
};

VirtualPlantParameters frictionOfAll(double spherical) {
  VirtualPlantParameters parameters;
  parameters.friction = equalFriction({150.0, 15.0}, {0.5, 0.2});
  parameters.spherical = {spherical, spherical};
  parameters.rotor_mass << 5.0, 6.0, 7.0, 8.0;
  return parameters;
}

TEST_P(VirtualPlants, MoveAllJointsAsOurKinematicsSays) {
  VirtualPlant virtual_plant = plant({});
  const AxisPath motion = path();
  mechanism::Pose pose = start_;
  for (double t = 0.0; t < kDuration_s; t += 0.01) {
    VirtualPlantOutput output;
    ASSERT_TRUE(virtual_plant.follow(motion.at(t), output));
    const mechanism::Motion platform = motionOf(motion.at(t), pose);
    const auto ours = mechanism::urdfJointPositions(mechanism(), platform.pose);
    const JointVector theirs = virtual_plant.robot().positions();
    for (int joint = 0; joint < mechanism::kUrdfJoints; ++joint)
      ASSERT_NEAR(ours[static_cast<std::size_t>(joint)], theirs[joint], 1e-9)
          << mechanism::urdfJointNames()[joint] << " at " << t;
  }
}

TEST_P(VirtualPlants, AgreeWithOurInverseDynamicsWithoutFriction) {
  VirtualPlantParameters parameters;
  parameters.rotor_mass << 5.0, 6.0, 7.0, 8.0;
  VirtualPlant virtual_plant = plant(parameters);
  dynamics::RobotInertia inertia = inertia_;
  inertia.rotor_mass = parameters.rotor_mass;
  const dynamics::RigidModel model(mechanism(), robot_.gravity, inertia);
  const AxisPath motion = path();
  mechanism::Pose pose = start_;
  double worst = 0.0;
  for (double t = 0.0; t < kDuration_s; t += 0.007) {
    VirtualPlantOutput output;
    ASSERT_TRUE(virtual_plant.follow(motion.at(t), output));
    mechanism::Vector4 ours;
    ASSERT_TRUE(dynamics::inverseDynamics(model, motionOf(motion.at(t), pose), ours));
    worst = std::max(worst, (ours - output.force).norm() / ours.norm());
    EXPECT_EQ(output.friction_power_W, 0.0);
  }
  std::printf("%s: largest relative difference %.1e\n", GetParam(), worst);
  EXPECT_LT(worst, 1e-6);
}

TEST_P(VirtualPlants, AgreeWithTheLinearModelWithFriction) {
  const VirtualPlantParameters parameters = frictionOfAll(0.0);
  VirtualPlant virtual_plant = plant(parameters);
  dynamics::PaperParameters paper;
  paper << dynamics::toParameters(inertia_), parameters.friction;
  dynamics::ExtendedParameters extended_parameters = dynamics::toExtended(paper);
  extended_parameters.segment<mechanism::kLegs>(dynamics::extended::kRotor) = parameters.rotor_mass;
  const AxisPath motion = path();
  mechanism::Pose pose = start_;
  dynamics::RegressorData data;
  dynamics::ExtendedRegressor regressor;
  for (double t = 0.2; t < kDuration_s; t += 0.0137) {
    VirtualPlantOutput output;
    ASSERT_TRUE(virtual_plant.follow(motion.at(t), output));
    ASSERT_TRUE(
        dynamics::extendedRegressor(mechanism(), robot_.gravity, motionOf(motion.at(t), pose), data, regressor));
    const mechanism::Vector4 ours = regressor * extended_parameters;
    ASSERT_LT((ours - output.force).norm(), 1e-6 * ours.norm()) << t;
  }
}

TEST_P(VirtualPlants, RubInTheirSphericalJointsAsTheLawThatTraceAdds) {
  expectLaw("platform_joint_friction", frictionOfAll(0.3), frictionOfAll(0.0),
            [](const dynamics::PoseColumns& c) { return mechanism::Vector4(0.3 * (c.col(4) + c.col(5))); });
}

TEST_P(VirtualPlants, RubInTheirJointsAtTheBaseAsTheLawThatTraceAdds) {
  VirtualPlantParameters without = frictionOfAll(0.0);
  without.friction = equalFriction({150.0, 15.0}, {0.0, 0.0});
  expectLaw("base_joint_friction", frictionOfAll(0.0), without, [](const dynamics::PoseColumns& c) {
    return mechanism::Vector4(0.5 * (c.col(1) + c.col(3)) + 0.2 * (c.col(0) + c.col(2)));
  });
}

TEST_P(VirtualPlants, LoseEnergyToFrictionOnlyAndKeepTheBooks) {
  for (const double spherical : {0.0, 0.3}) {
    VirtualPlant virtual_plant = plant(frictionOfAll(spherical));
    const AxisPath motion = path();
    VirtualPlantOutput output;
    ASSERT_TRUE(virtual_plant.follow(motion.at(0.0), output));
    const double start_J = virtual_plant.energy();
    double work = 0.0, dissipated = 0.0, worst = 0.0;
    constexpr double kStep_s = 1e-3;
    for (int k = 0; k < std::lround(kDuration_s / kStep_s); ++k) {
      ASSERT_TRUE(virtual_plant.follow(motion.at((k + 0.5) * kStep_s), output));
      ASSERT_LE(output.friction_power_W, 0.0);
      work += kStep_s * output.motor_power_W;
      dissipated -= kStep_s * output.friction_power_W;
      ASSERT_TRUE(virtual_plant.follow(motion.at((k + 1) * kStep_s), output));
      worst = std::max(worst, std::abs(work - dissipated - (virtual_plant.energy() - start_J)));
    }
    std::printf("%s, spherical %.1f: work %.3f J, dissipated %.3f J, books open by %.1e J\n", GetParam(), spherical,
                work, dissipated, worst);
    EXPECT_GT(dissipated, 1.0);
    EXPECT_LT(worst, 1e-4 * dissipated);
  }
}

TEST_P(VirtualPlants, RecordWholeCountsAndHeldForces) {
  const std::string file = (std::filesystem::temp_directory_path() /
                            ("knee_virtual_plant_" + std::string(GetParam()) + std::to_string(getpid()) + ".csv"))
                               .string();
  std::filesystem::remove(file);
  VirtualPlant virtual_plant = plant(frictionOfAll(0.0));
  const AxisPath motion = path();
  const VirtualRun run = recordVirtualPlant(robot_, virtual_plant, motion, {}, file);
  const recording::Recording recording = recording::loadRecording(file);
  EXPECT_EQ(recording.rows(), run.rows);
  EXPECT_EQ(recording.rows(), 501);
  VirtualPlant again = plant(frictionOfAll(0.0));
  for (int row : {100, 200, 300}) {
    const double time = recording.time_s[static_cast<std::size_t>(row)];
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const mechanism::Actuator& actuator = robot_.actuators[static_cast<std::size_t>(i)];
      const double counts = (recording.position_m(row, i) - actuator.home_length_m) / actuator.metresPerCount();
      EXPECT_NEAR(counts, std::round(counts), 1e-3);
      EXPECT_NEAR(recording.position_m(row, i), motion.at(time).position[i], 0.51 * actuator.metresPerCount());
    }
    // The force of the row is the mean until the next one.
    VirtualPlantOutput output;
    for (double t = 0.0; t < time; t += kPeriod_s)  // small steps to get there
      ASSERT_TRUE(again.follow(motion.at(t), output));
    mechanism::Vector4 mean = mechanism::Vector4::Zero();
    for (int k = 0; k < 10; ++k) {
      ASSERT_TRUE(again.follow(motion.at(time + (k + 0.5) * 1e-3), output));
      mean += 0.1 * output.force;
    }
    EXPECT_LT((recording.force_N.row(row).transpose() - mean).norm(), 1e-3) << row;
  }
  EXPECT_THROW(recordVirtualPlant(robot_, virtual_plant, motion, {}, file), InputError);  // never overwritten
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(BothGeometries, VirtualPlants, testing::Values("final", "starting"));

TEST(AxisPaths, PassThroughTheirPointsWithTheRightDerivatives) {
  Eigen::Matrix<double, Eigen::Dynamic, mechanism::kLegs> points(201, mechanism::kLegs);
  const auto exact = [](double t) { return std::pow(std::sin(1.5707963267948966 * t), 4); };  // at rest at 0 and 2
  for (Eigen::Index k = 0; k <= 200; ++k)
    points.row(k).setConstant(exact(0.01 * static_cast<double>(k)));
  const AxisPath path(points, 0.01);
  EXPECT_DOUBLE_EQ(path.duration(), 2.0);
  for (double t = 0.0037; t < 2.0; t += 0.0041) {
    const double h = 1e-4, velocity = (exact(t + h) - exact(t - h)) / (2 * h);
    const double acceleration = (exact(t + h) - 2 * exact(t) + exact(t - h)) / (h * h);
    EXPECT_NEAR(path.at(t).position[2], exact(t), 1e-7);
    EXPECT_NEAR(path.at(t).velocity[2], velocity, 1e-4);
    EXPECT_NEAR(path.at(t).acceleration[2], acceleration, 2e-2);
  }
  for (const double t : {-1.0, 0.0, 2.0, 3.0}) {
    EXPECT_EQ(path.at(t).velocity, mechanism::Vector4(mechanism::Vector4::Zero()));
    EXPECT_NEAR(path.at(t).position[0], 0.0, 1e-12);
  }
}

TEST(VirtualPlantFriction, BuildsUpOverThePreslidingDisplacementAndStays) {
  const mechanism::Robot robot = mechanism::configuredRobot("final");
  VirtualPlantParameters parameters;
  parameters.friction = equalFriction({0.0, 15.0}, {});
  parameters.presliding_m = 1e-5;
  mechanism::Lengths start;
  for (int i = 0; i < mechanism::kLegs; ++i)
    start[i] = robot.actuators[static_cast<std::size_t>(i)].home_length_m + 0.05;
  const mechanism::Pose pose = mechanism::forwardKinematicsFromHome(*robot.mechanism, start).pose;
  const dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);
  VirtualPlant with(*robot.mechanism, robot.gravity, inertia, pose, parameters);
  VirtualPlant without(*robot.mechanism, robot.gravity, inertia, pose, {});
  const auto frictionAfter = [&](double displacement) {
    AxisMotion motion;
    motion.position = start + displacement * mechanism::Vector4::Unit(1);
    VirtualPlantOutput a, b;
    EXPECT_TRUE(with.follow(motion, a));
    EXPECT_TRUE(without.follow(motion, b));
    return (a.force - b.force)[1];
  };
  EXPECT_NEAR(frictionAfter(5e-6), 7.5, 1e-6);
  EXPECT_NEAR(frictionAfter(3e-5), 15.0, 1e-6);
  EXPECT_NEAR(frictionAfter(3e-5), 15.0, 1e-6);  // at rest it stays
  EXPECT_NEAR(frictionAfter(1e-5), -15.0, 1e-6);
}

}  // namespace
}  // namespace knee_robot::simulation
