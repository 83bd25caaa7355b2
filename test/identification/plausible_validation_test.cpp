// Recordings that take no part in the fit may be of another machine, sign or unit.
#include "knee_robot/identification/plausible_validation.h"

#include <gtest/gtest.h>

#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/evaluation.h"
#include "test/identification/observe_one.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

class PlausibleValidation : public testing::Test {
 protected:
  PlausibleValidation() { options_.uncertainty = false; }
  recording::Recording noisy(int variant) const {
    std::mt19937 random(3 + static_cast<unsigned>(variant));
    std::normal_distribution<double> normal(0.0, 2.0);
    return syntheticRecording(robot_, syntheticModel(robot_), variant, 30.0, [&] { return normal(random); });
  }
  /// Of a model that was trained on a sound recording.
  std::vector<std::string> doubtsAbout(const recording::Recording& validation) const {
    std::vector<Observation> training = observeOne(robot_, noisy(0), options_);
    const Identification id = identify(robot_, training, options_);
    const std::vector<Observation> held = observeOne(robot_, validation, options_);
    const double cutoff_hz = options_.observation.cutoff_hz;
    return doubtsAboutValidation(robot_, held, applyModel(id.model, robot_, held, cutoff_hz).predictions,
                                 applyModel(id.model, robot_, training, cutoff_hz).accuracy);
  }

  const mechanism::Robot robot_ = syntheticRobot();
  IdentifyOptions options_;
};

TEST_F(PlausibleValidation, DoubtsNothingAboutAnotherSoundRecording) {
  EXPECT_TRUE(doubtsAbout(noisy(1)).empty());
}

TEST_F(PlausibleValidation, TellsTheActuatorWhoseForceHasAnotherSign) {
  recording::Recording r = noisy(1);
  r.force_N.col(1) *= -1.0;
  const std::vector<std::string> doubts = doubtsAbout(r);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("at actuator 2; of -1 times that force, "), std::string::npos) << doubts[0];
}

TEST_F(PlausibleValidation, TellsTheActuatorWhoseForceIsInAnotherUnit) {
  recording::Recording r = noisy(1);
  r.force_N.col(3) *= 0.1;
  const std::vector<std::string> doubts = doubtsAbout(r);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("at actuator 4; of 10 times that force, "), std::string::npos) << doubts[0];
}

TEST_F(PlausibleValidation, AsksWhetherItIsOfThisMachineWhereNothingFits) {
  recording::Recording r = noisy(1);
  r.force_N.col(0).swap(r.force_N.col(1));
  const std::vector<std::string> doubts = doubtsAbout(r);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].find("is it of this machine"), std::string::npos) << doubts[0];
}

TEST_F(PlausibleValidation, RefusesForcesThatNeverChange) {
  recording::Recording r = noisy(1);
  r.force_N.setZero();
  EXPECT_THROW(requireForces(robot_, observeOne(robot_, r, options_), options_.observation), Refusal);
  EXPECT_NO_THROW(requireForces(robot_, observeOne(robot_, noisy(1), options_), options_.observation));
}

}  // namespace
}  // namespace knee_robot::identification
