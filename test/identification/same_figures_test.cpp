// Columns, equations, prior and predictions of the parallel robot and the bench, as they were before they came from a
// MotionModel; since then the ends of a recording may accelerate, which changes equations by 4e-9 and 3e-8 of themselves.

#include <gtest/gtest.h>

#include "knee_robot/identification/equations.h"
#include "knee_robot/identification/prediction.h"
#include "knee_robot/identification/prior.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

struct Figures {
  Eigen::MatrixXd force_N;  ///< at samples 300, 900, 1500
  double equations, right_side, prior, mean;
};

void expectFigures(const mechanism::Robot& robot, const Figures& before) {
  const dynamics::Model model = syntheticModel(robot);
  const ObservationOptions options;
  const std::vector<Column> columns = columnsOf(robot);
  std::vector<Observation> o = {observe(robot, columns, syntheticRecording(robot, model, 0, 20.0), options)};
  setFriction(o.front(), columns, model.friction);
  const Eigen::MatrixXd force = predictForces(model, robot, o.front().signals, o.front().motion).mean_N;
  for (int k = 0; k < 3; ++k) {
    for (Eigen::Index i = 0; i < force.cols(); ++i)
      EXPECT_NEAR(force(300 + 600 * k, i), before.force_N(k, i), 1e-9) << "actuator " << i + 1;
  }
  const Equations e = stackEquations(o, options);
  const Prior prior = priorOf(robot, columns, rmsPerActuator(e, e.b));
  EXPECT_NEAR(e.a.norm() / before.equations, 1.0, 1e-12);
  EXPECT_NEAR(e.b.norm() / before.right_side, 1.0, 1e-12);
  EXPECT_NEAR(prior.transform.norm() / before.prior, 1.0, 1e-12);
  EXPECT_NEAR(prior.mean.norm(), before.mean, 1e-11);
}

TEST(SameFigures, OfTheParallelRobot) {
  Figures f{Eigen::MatrixXd(3, 4), 2929.51177605389, 4867.54960473716, 26.0346879406967, 17.3620275313686};
  f.force_N << -20.824178385264, -66.011520921364, -66.1661003070418, 81.6882080705831,  //
      -23.6184519454458, 17.162427460381, 0.977562436210548, 67.8348935207934,           //
      52.0872657324736, 32.3231350268624, 130.326995536586, 62.6993341812172;
  expectFigures(syntheticRobot(), f);
}

TEST(SameFigures, OfTheBench) {
  Figures f{Eigen::MatrixXd(3, 2), 50.3212863014778, 1774.82350012142, 6.99378434982299, 0.0};
  f.force_N << -50.8459286125974, -39.0620787905495,  //
      -0.167153781304577, 43.0730969160361,           //
      -35.6750556886575, -1.04947482655525;
  expectFigures(syntheticBench(2), f);
}

}  // namespace
}  // namespace knee_robot::identification
