#include "knee_robot/identification/identify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/evaluation.h"
#include "knee_robot/mechanism/singularity.h"
#include "test/identification/observe_one.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

TEST(Identify, RecoversKnownFrictionAndPredictsAnotherTrajectory) {
  const mechanism::Robot robot = syntheticRobot();
  const dynamics::Model truth = syntheticModel(robot);
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0.0, 0.5);
  const auto noise = [&] { return normal(random); };
  const IdentifyOptions options;
  auto train = observeOne(robot, syntheticRecording(robot, truth, 0, 60.0, noise), options);
  auto validate = observeOne(robot, syntheticRecording(robot, truth, 1, 30.0, noise), options);
  const Identification id = identify(robot, train, options);
  for (const char* leg : {"13", "23", "33", "42"}) {
    const std::string coulomb = std::string("Fc_") + leg, viscous = std::string("Fv_") + leg;
    EXPECT_NEAR(parameterValue(id.model, coulomb), parameterValue(truth, coulomb),
                0.03 * parameterValue(truth, coulomb));
    EXPECT_NEAR(parameterValue(id.model, viscous), parameterValue(truth, viscous),
                0.1 * parameterValue(truth, viscous));
  }
  const Applied applied = applyModel(id.model, robot, validate, options.observation.cutoff_hz);
  // What cannot be explained: the filtered noise (0.1 N) and the friction's reversals seen through 100 Hz samples.
  EXPECT_LT(applied.accuracy.rms_moving_N.maxCoeff(), 0.6);
  EXPECT_LT(applied.accuracy.rms_percent.maxCoeff(), 2.0);
}

TEST(Identify, HoldsLinksAtLeastAsStronglyAsItIsTold) {
  const mechanism::Robot robot = syntheticRobot();
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.5);
  IdentifyOptions options;
  options.uncertainty = false;
  auto train = observeOne(
      robot, syntheticRecording(robot, syntheticModel(robot), 0, 20.0, [&] { return normal(random); }), options);
  const Identification free = identify(robot, train, options);
  options.least_strength = 1e3 * free.prior.strength;
  const Identification held = identify(robot, train, options);
  EXPECT_EQ(held.prior.strength, options.least_strength);
  EXPECT_LT(held.model.rank, free.model.rank);
  options.least_strength = 1e-3 * free.prior.strength;
  EXPECT_EQ(identify(robot, train, options).prior.strength, free.prior.strength);
}

TEST(Identify, StandardErrorsCoverTheTruth) {
  const mechanism::Robot robot = syntheticBench(3);
  const dynamics::Model truth = syntheticModel(robot);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 2.0);
  const IdentifyOptions options;
  auto train = observeOne(robot, syntheticRecording(robot, truth, 0, 60.0, [&] { return normal(random); }), options);
  const Identification id = identify(robot, train, options);
  for (const dynamics::ModelParameter& p : id.model.parameters) {
    EXPECT_GT(p.std, 0.0) << p.name;
    EXPECT_NEAR(p.value, parameterValue(truth, p.name), 6.0 * p.std + 0.01 * std::abs(p.value)) << p.name;
  }
}

TEST(Identify, WorksForBenchAxesOfAnyNumber) {
  for (int axes = 1; axes <= 4; ++axes) {
    const mechanism::Robot robot = syntheticBench(axes);
    const dynamics::Model truth = syntheticModel(robot);
    const IdentifyOptions options;
    auto train = observeOne(robot, syntheticRecording(robot, truth, 0, 40.0), options);
    const Identification id = identify(robot, train, options);
    EXPECT_EQ(id.model.rank, 4 * axes);
    for (const dynamics::ModelParameter& p : truth.parameters) {
      EXPECT_NEAR(parameterValue(id.model, p.name), p.value, 0.03 * std::abs(p.value)) << p.name;
    }
  }
}

TEST(Identify, NeverMakesFrictionOrRotorInertiaNegative) {
  const mechanism::Robot robot = syntheticBench(2);
  dynamics::Model truth = syntheticModel(robot);
  truth.parameters[0].value = -50.0;  // a viscous coefficient that no friction has
  const IdentifyOptions options;
  auto train = observeOne(robot, syntheticRecording(robot, truth, 0, 40.0), options);
  const Identification id = identify(robot, train, options);
  EXPECT_EQ(id.model.parameters[0].value, 0.0);
  EXPECT_EQ(id.model.parameters[0].verdict, "at its bound");
  EXPECT_GT(id.model.parameters[1].value, 0.0);
}

TEST(Identify, OutliersHardlyMoveTheRobustFit) {
  const mechanism::Robot robot = syntheticBench(1);
  const dynamics::Model truth = syntheticModel(robot);
  const IdentifyOptions options;
  recording::Recording r = syntheticRecording(robot, truth, 0, 60.0);
  for (int k = 1000; k < 1040; ++k)
    r.force_N(k, 0) += 400.0;  // something pushed
  auto train = observeOne(robot, r, options);
  const Identification id = identify(robot, train, options);
  EXPECT_NEAR(parameterValue(id.model, "Fc_1"), parameterValue(truth, "Fc_1"), 0.03 * parameterValue(truth, "Fc_1"));
  EXPECT_NEAR(parameterValue(id.model, "offset_1"), parameterValue(truth, "offset_1"), 0.5);
}

TEST(Identify, TukeysWeightsForgetOutliersThatHuberOnlySoftens) {
  const mechanism::Robot robot = syntheticBench(1);
  const dynamics::Model truth = syntheticModel(robot);
  recording::Recording r = syntheticRecording(robot, truth, 0, 60.0);
  for (int k = 500; k < 5500; k += 470) {
    for (int n = 0; n < 60; ++n)
      r.force_N(k + n, 0) += 300.0;  // one push in eight samples, always to the same side, here and there on the way
  }
  double error[3] = {};
  for (const OutlierRule rule : {OutlierRule::None, OutlierRule::Huber, OutlierRule::Bisquare}) {
    IdentifyOptions options;
    options.outliers = rule;
    auto train = observeOne(robot, r, options);
    const Identification id = identify(robot, train, options);
    error[static_cast<int>(rule)] = std::abs(parameterValue(id.model, "offset_1") - parameterValue(truth, "offset_1"));
  }
  std::cout << "error of the offset, N: least squares " << error[static_cast<int>(OutlierRule::None)] << ", Huber "
            << error[static_cast<int>(OutlierRule::Huber)] << ", Tukey "
            << error[static_cast<int>(OutlierRule::Bisquare)] << "\n";
  EXPECT_LT(error[static_cast<int>(OutlierRule::Huber)], 0.7 * error[static_cast<int>(OutlierRule::None)]);
  EXPECT_LT(error[static_cast<int>(OutlierRule::Bisquare)], 0.1 * error[static_cast<int>(OutlierRule::Huber)]);
}

TEST(Identify, RefusesDataThatCannotSupportAModel) {
  const mechanism::Robot robot = syntheticBench(2);
  const dynamics::Model truth = syntheticModel(robot);
  const IdentifyOptions options;

  recording::Recording still = syntheticRecording(robot, truth, 0, 20.0);
  still.position_m.col(1).setConstant(0.2);
  auto motionless = observeOne(robot, still, options);
  try {
    identify(robot, motionless, options);
    FAIL() << "an axis stands still";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("actuator 2 does not move"), std::string::npos) << refusal.what();
  }

  auto brief = observeOne(robot, syntheticRecording(robot, truth, 0, 1.0), options);
  EXPECT_THROW(identify(robot, brief, options), Refusal);

  recording::Recording loud = syntheticRecording(robot, truth, 0, 20.0);
  loud.force_N.setConstant(1000.0);  // 10 V times 100 N/V
  auto saturated = observeOne(robot, loud, options);
  EXPECT_THROW(identify(robot, saturated, options), Refusal);
}

TEST(Identify, RefusesARankThatTheMotionDoesNotExcite) {
  const mechanism::Robot robot = syntheticBench(2);
  auto train = observeOne(robot, syntheticRecording(robot, syntheticModel(robot), 0, 20.0), IdentifyOptions());
  IdentifyOptions options;
  options.rank = 8;
  EXPECT_EQ(identify(robot, train, options).model.rank, 8);
  options.rank = 9;
  try {
    identify(robot, train, options);
    FAIL() << "two axes have eight parameters";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("9 directions were asked for"), std::string::npos) << refusal.what();
  }
  options.rank = 3;
  EXPECT_THROW(identify(robot, train, options), InputError);
}

TEST(Observe, RefusesARecordingOfAnotherRobot) {
  const mechanism::Robot robot = syntheticRobot();
  const mechanism::Robot bench = syntheticBench(4);
  const IdentifyOptions options;
  const recording::Recording from_bench =
      syntheticRecording(bench, syntheticModel(bench), 0, 5.0);  // positions of 0.13 to 0.27 m
  EXPECT_THROW(observe(robot, columnsOf(robot), from_bench, options.observation), Refusal);
  const mechanism::Robot two = syntheticBench(2);
  EXPECT_THROW(observe(two, columnsOf(two), from_bench, options.observation), InputError);
}

TEST(Observe, MasksPosesBeyondTheConditionLimit) {
  const mechanism::Robot robot = syntheticRobot();
  IdentifyOptions options;
  options.observation.condition_max = 1.0;  // no pose is that good
  const Observation o =
      observe(robot, columnsOf(robot), syntheticRecording(robot, syntheticModel(robot), 0, 5.0), options.observation);
  for (const char usable : o.usable)
    ASSERT_EQ(usable, 0);
  EXPECT_EQ(o.masks.back().reason, "used in the fit");
  EXPECT_EQ(o.masks.back().share, 0.0);
  const bool said = std::any_of(o.notes.begin(), o.notes.end(), [](const std::string& note) {
    return note.find("100 % of the samples have a Jacobian condition above 1") != std::string::npos;
  });
  EXPECT_TRUE(said);
}

TEST(Observe, MasksWhereTheLengthsDoNotTellTheAssemblyMode) {
  const mechanism::Robot robot = syntheticRobot();
  const recording::Recording r = syntheticRecording(robot, syntheticModel(robot), 0, 20.0);
  IdentifyOptions options;
  options.observation.condition_max = 1e9;
  const Observation free = observe(robot, columnsOf(robot), r, options.observation);
  double nearest = 1e9;
  for (const mechanism::Motion& motion : free.motion.motion)
    nearest = std::min(nearest, mechanism::foldDistance(*robot.mechanism, motion.pose));
  options.observation.fold_margin_m = 1.1 * nearest;
  const Observation some = observe(robot, columnsOf(robot), r, options.observation);
  int left_out = 0;
  for (int n = 0; n < some.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    const bool near = mechanism::foldDistance(*robot.mechanism, some.motion.motion[i].pose) < 1.1 * nearest;
    EXPECT_TRUE(!near || !some.usable[i]);
    left_out += free.usable[i] && !some.usable[i];
  }
  EXPECT_GT(left_out, 0);
  EXPECT_LT(left_out, some.samples());
  const bool said = std::any_of(some.notes.begin(), some.notes.end(), [](const std::string& note) {
    return note.find("encoders cannot tell") != std::string::npos;
  });
  EXPECT_TRUE(said);
}

}  // namespace
}  // namespace knee_robot::identification
