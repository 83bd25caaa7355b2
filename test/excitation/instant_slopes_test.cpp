#include "src/excitation/instant_slopes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/dynamics/robot_inertia.h"
#include "test/trajectory/robots.h"

namespace knee_robot::excitation {
namespace {

constexpr dynamics::CoulombWidth kWidth{2e-3, 5e-3};
using Inputs = Eigen::Matrix<double, 12, 1>;

/// One instant of a robot, looked at through actuator lengths, velocities and accelerations.
class Looked {
 public:
  Looked(const std::string& name, unsigned seed) : robot_(trajectory::configuredRobot(name)), random_(seed) {
    const dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot_);
    load_.parameters.head<dynamics::kInertialParameters>() = dynamics::toParameters(inertia);
    for (int k = dynamics::kInertialParameters; k < dynamics::kPaperParameters; ++k)
      load_.parameters[k] = k % 2 == 0 ? 40.0 : 8.0;
    load_.rotor_mass << 5.0, 6.0, 7.0, 8.0;
    pose_ = mechanism::Pose(0.02, 0.68, 0.12, -0.08) + 0.05 * noise<4>();
    inputs_ << mechanism::legLengths(*robot_.mechanism, pose_), 0.02 * noise<4>(), 0.3 * noise<4>();
    for (double& w : weights_.reshaped())
      w = normal_(random_);
  }

  mechanism::Motion motion(const Inputs& inputs) const {
    mechanism::Motion motion;
    EXPECT_EQ(mechanism::motionFromLengths(*robot_.mechanism, inputs.head<4>(), inputs.segment<4>(4), inputs.tail<4>(),
                                           pose_, motion),
              mechanism::ForwardStatus::Converged);
    return motion;
  }

  PaperRegressor regressor(const mechanism::Motion& motion) const {
    dynamics::RegressorData data;
    EXPECT_TRUE(dynamics::projectedRegressor(*robot_.mechanism, robot_.gravity, motion, data, kWidth));
    return data.k;
  }

  /// The same quantities from the ordinary functions of mechanism and dynamics.
  Eigen::Matrix<double, slope_row::kRows, 1> values(const Inputs& inputs) const {
    const mechanism::Motion at = motion(inputs);
    const PaperRegressor k = regressor(at);
    const mechanism::JointAngles angles = mechanism::jointAngles(*robot_.mechanism, at.pose);
    Eigen::Matrix<double, slope_row::kRows, 1> v;
    v[slope_row::kObservation] = k.cwiseProduct(weights_).sum();
    for (int i = 0; i < 4; ++i)
      v[slope_row::kBaseCosine + i] = std::cos(angles.base[i]);
    for (int i = 0; i < 3; ++i)
      v[slope_row::kTipCosine + i] = std::cos(angles.platform[i]);
    v[slope_row::kCondition] = std::log(mechanism::conditionNumber(*robot_.mechanism, at.pose));
    v.tail<4>() = k * load_.parameters + load_.rotor_mass.cwiseProduct(mechanism::Vector4(inputs.tail<4>()));
    return v;
  }

  InstantSlopes slopes() const {
    const mechanism::Motion at = motion(inputs_);
    return instantSlopes(*robot_.mechanism, robot_.gravity, at, kWidth, regressor(at), weights_, load_);
  }

  const Inputs& inputs() const { return inputs_; }

 private:
  template <int N>
  Eigen::Matrix<double, N, 1> noise() {
    Eigen::Matrix<double, N, 1> v;
    for (double& x : v)
      x = normal_(random_);
    return v;
  }

  mechanism::Robot robot_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  ExpectedLoad load_;
  PaperRegressor weights_;
  mechanism::Pose pose_;
  Inputs inputs_;
};

TEST(InstantSlopes, HaveTheValuesOfMechanismAndDynamics) {
  for (const char* name : {"A", "B", "final"}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const Looked at(name, seed);
      const auto expected = at.values(at.inputs());
      const auto found = at.slopes().value;
      for (int row = 0; row < slope_row::kRows; ++row)
        EXPECT_NEAR(found[row], expected[row], 1e-9 * (1.0 + std::abs(expected[row]))) << name << " row " << row;
    }
  }
}

TEST(InstantSlopes, AgreeWithDifferencesOfTheValues) {
  for (const char* name : {"A", "B", "final"}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const Looked at(name, seed);
      const InstantSlopes exact = at.slopes();
      for (int column = 0; column < 12; ++column) {
        // Fourth-order differences; the velocity's step is small beside the Coulomb width.
        const double h = column < 4 ? 2e-5 : column < 8 ? 2e-5 : 1e-3;
        const auto shifted = [&](double by) {
          Inputs inputs = at.inputs();
          inputs[column] += by;
          return at.values(inputs);
        };
        const Eigen::Matrix<double, slope_row::kRows, 1> slope =
            (8.0 * (shifted(h) - shifted(-h)) - (shifted(2 * h) - shifted(-2 * h))) / (12.0 * h);
        for (int row = 0; row < slope_row::kRows; ++row) {
          const double size = exact.slope.row(row).cwiseAbs().maxCoeff();
          EXPECT_NEAR(exact.slope(row, column), slope[row], 2e-6 * size)
              << name << " row " << row << " column " << column;
        }
      }
    }
  }
}

}  // namespace
}  // namespace knee_robot::excitation
