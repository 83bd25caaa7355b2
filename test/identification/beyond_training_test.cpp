// A recording that leaves the places of training is said to.
#include "knee_robot/identification/beyond_training.h"

#include <gtest/gtest.h>

#include "knee_robot/base/numbers.h"
#include "test/identification/observe_one.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

class BeyondTraining : public testing::Test {
 protected:
  std::vector<Observation> observed() const {
    return observeOne(robot_, syntheticRecording(robot_, syntheticModel(robot_), 0, 20.0, [] { return 0.0; }), {});
  }
  std::string of(const std::vector<Observation>& validation) const {
    return beyondTraining(robot_, training_, validation).at(0);
  }

  const mechanism::Robot robot_ = syntheticRobot();
  const std::vector<Observation> training_ = observed();
};

TEST_F(BeyondTraining, SaysNothingOfTheSamePlaces) {
  EXPECT_EQ(of(observed()), "");
}

TEST_F(BeyondTraining, TellsThePoseThatTrainingDoesNotReachAndHowOften) {
  std::vector<Observation> held = observed();
  double top = -1.0;
  for (mechanism::Motion& motion : held[0].motion.motion) {
    motion.pose[2] = 2.0 * std::max(0.01, motion.pose[2]);
    top = std::max(top, motion.pose[2]);
  }
  const std::string said = of(held);
  const double degrees = top * 180.0 / M_PI;
  EXPECT_NE(said.find(" % of the samples lie beyond the places of training (theta " + shortNumber(degrees, 3) +
                      " deg where training ends at " + shortNumber(0.5 * degrees, 3) + ")"),
            std::string::npos)
      << said;
}

TEST_F(BeyondTraining, LooksAtNoPoseThatIsNotKnown) {
  std::vector<Observation> held = observed();
  for (std::size_t n = 0; n < held[0].motion.motion.size(); n += 2) {
    held[0].motion.motion[n].pose[0] = 9.0;
    held[0].motion.pose_known[n] = 0;
  }
  EXPECT_EQ(of(held), "");
}

TEST_F(BeyondTraining, AFewSamplesAreNotWorthASentence) {
  std::vector<Observation> held = observed();
  held[0].motion.motion[500].pose[0] = 9.0;
  EXPECT_EQ(of(held), "");
}

}  // namespace
}  // namespace knee_robot::identification
