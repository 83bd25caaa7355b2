// Regressor of an open chain: against KDL's recursive Newton-Euler, Pinocchio's figures, and the balance of energy.
#include "knee_robot/dynamics/chain_regressor.h"

#include <gtest/gtest.h>

#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <random>

#include "knee_robot/base/errors.h"
#include "test/allocation_guard.h"

namespace knee_robot::dynamics {
namespace {

const char* const kUrdf = KNEE_SOURCE_DIR "/test/dynamics/chain.urdf";
const mechanism::Vector3 kDownwards(0.0, 0.0, -9.81);

/// The arm with its rail; the finger beside the chain locked half open.
mechanism::Robot arm(double finger_m = 0.0) {
  mechanism::Robot robot;
  robot.kind = mechanism::MechanismKind::Chain;
  robot.urdf = kUrdf;
  std::vector<mechanism::ChainLimits> limits;
  robot.chain = mechanism::readChain(kUrdf, "base", "tool", {{"finger_joint", true, finger_m}}, limits);
  return robot;
}

Eigen::VectorXd torque(const mechanism::Robot& robot, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                       const Eigen::VectorXd& a) {
  ChainRegressorData data(*robot.chain);
  chainRegressor(*robot.chain, kDownwards, q, v, a, data);
  return data.regressor * chainInertia(robot);
}

Eigen::VectorXd six(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(), 6);
}

Eigen::VectorXd random(std::mt19937& dice, double size) {
  Eigen::VectorXd out(6);
  for (double& value : out)
    value = size * (2.0 * static_cast<double>(dice()) / 4294967296.0 - 1.0);
  return out;
}

TEST(ChainRegressor, GivesPinocchiosTorquesToTenDigits) {
  // pinocchio 4.1.0, buildReducedModel with finger_joint at 0.02 m, rnea
  const mechanism::Robot robot = arm(0.02);
  const Eigen::VectorXd first = six({-36.9709207939564, -0.488323560142373, 2.22512235869453, 8.22107557056808,
                                     0.60825194543226, -0.214244475251472});
  const Eigen::VectorXd second = six({-90.6010646366978, 6.2644620036277, 8.46177534622902, -5.32225239734071,
                                      -0.0609906378933451, 0.295058942286101});
  const Eigen::VectorXd here = torque(robot, six({0.1, 0.4, -0.7, 1.1, 2.0, -0.9}),
                                      six({0.3, -0.8, 1.2, 0.5, -1.5, 0.9}), six({1.0, 2.0, -3.0, 0.7, 4.0, -2.5}));
  const Eigen::VectorXd there = torque(robot, six({-0.4, -2.1, 1.3, -2.0, -3.0, 1.6}),
                                       six({-0.6, 1.7, -0.4, 2.1, 0.2, -2.2}), six({-2.0, 0.5, 5.0, -1.0, -3.0, 6.0}));
  EXPECT_LT((here - first).cwiseAbs().maxCoeff(), 1e-10) << here.transpose();
  EXPECT_LT((there - second).cwiseAbs().maxCoeff(), 1e-10) << there.transpose();
}

TEST(ChainRegressor, GivesKdlsTorquesEverywhere) {
  KDL::Tree tree;
  ASSERT_TRUE(kdl_parser::treeFromFile(kUrdf, tree));
  KDL::Chain chain;
  ASSERT_TRUE(tree.getChain("base", "tool", chain));
  KDL::ChainIdSolver_RNE solver(chain, KDL::Vector(0.0, 0.0, -9.81));
  mechanism::Robot robot = arm();
  auto& links = robot.chain->joints.back().links;  // KDL's chain ends with the tool and knows no finger
  links.erase(std::remove_if(links.begin(), links.end(), [](const auto& link) { return link.name == "finger"; }),
              links.end());
  std::mt19937 dice(3);
  for (int k = 0; k < 50; ++k) {
    KDL::JntArray q(6), v(6), a(6), out(6);
    q.data = random(dice, 3.0);
    v.data = random(dice, 2.0);
    a.data = random(dice, 8.0);
    ASSERT_EQ(solver.CartToJnt(q, v, a, KDL::Wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero()), out), 0);
    EXPECT_LT((torque(robot, q.data, v.data, a.data) - out.data).cwiseAbs().maxCoeff(), 1e-10);
  }
}

/// Kinetic and potential energy from the links' poses alone.
double energy(const mechanism::Robot& robot, const std::function<Eigen::VectorXd(double)>& path, double t) {
  constexpr double h = 1e-5;
  const auto before = mechanism::bodyFrames(*robot.chain, path(t - h)),
             here = mechanism::bodyFrames(*robot.chain, path(t)),
             after = mechanism::bodyFrames(*robot.chain, path(t + h));
  double sum = 0.0;
  for (std::size_t j = 0; j < here.size(); ++j) {
    const mechanism::Matrix3 rate = (after[j].linear() - before[j].linear()) / (2.0 * h);
    const mechanism::Matrix3 spin = here[j].linear().transpose() * rate;
    const mechanism::Vector3 omega(spin(2, 1), spin(0, 2), spin(1, 0));
    for (const mechanism::ChainLink& link : robot.chain->joints[j].links) {
      const mechanism::Vector3 velocity = (after[j] * link.center - before[j] * link.center) / (2.0 * h);
      sum += 0.5 * link.mass * velocity.squaredNorm() + 0.5 * omega.dot(link.inertia * omega) -
             link.mass * kDownwards.dot(here[j] * link.center);
    }
  }
  return sum;
}

TEST(ChainRegressor, PowerOfTheJointsIsTheChangeOfEnergy) {
  const mechanism::Robot robot = arm();
  const auto path = [](double t) {
    Eigen::VectorXd q(6);
    for (int i = 0; i < 6; ++i)
      q[i] = 0.4 * std::sin((1.0 + 0.3 * i) * t + i) + 0.1 * i;
    return q;
  };
  const double h = 1e-4;
  for (double t = 0.0; t < 5.0; t += 0.7) {
    const Eigen::VectorXd v = (path(t + h) - path(t - h)) / (2.0 * h);
    const Eigen::VectorXd a = (path(t + h) - 2.0 * path(t) + path(t - h)) / (h * h);
    const double power = torque(robot, path(t), v, a).dot(v);
    const double change = (energy(robot, path, t + 1e-3) - energy(robot, path, t - 1e-3)) / 2e-3;
    EXPECT_NEAR(power, change, 1e-4 * (1.0 + std::abs(power))) << "at " << t << " s";
  }
}

TEST(ChainRegressor, JacobianIsTheTipsVelocityPerJointVelocity) {
  const mechanism::Robot robot = arm();
  const Eigen::VectorXd q = six({0.1, 0.4, -0.7, 1.1, 2.0, -0.9});
  const mechanism::Vector3 at(0.02, -0.1, 0.05);
  const auto jacobian = chainJacobian(*robot.chain, q, at);
  for (int i = 0; i < 6; ++i) {
    const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(6, i);
    const mechanism::Vector3 moved = mechanism::bodyFrames(*robot.chain, q + step).back() * at -
                                     mechanism::bodyFrames(*robot.chain, q - step).back() * at;
    EXPECT_LT((jacobian.col(i).head<3>() - moved / 2e-6).norm(), 1e-8) << "joint " << i + 1;
  }
}

TEST(ChainRegressor, AllocatesNothing) {
  const mechanism::Robot robot = arm();
  ChainRegressorData data(*robot.chain);
  const Eigen::VectorXd q = six({0.1, 0.4, -0.7, 1.1, 2.0, -0.9});
  chainRegressor(*robot.chain, kDownwards, q, q, q, data);
  allocations = 0;
  armed = true;
  chainRegressor(*robot.chain, kDownwards, q, q, q, data);
  armed = false;
  EXPECT_EQ(allocations, 0);
}

}  // namespace
}  // namespace knee_robot::dynamics
