// Pinocchio's joint torque regressor beside the project's on the same open chain: compared to ten digits on chains of
// every kind of joint, then timed in the same run on the arm of chain.urdf. Part of the program of pinocchio_peer.cpp.
#include <benchmark/benchmark.h>

#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>
#include <random>

#include "knee_robot/dynamics/chain_regressor.h"

namespace pin = pinocchio;
using namespace knee_robot;
using namespace knee_robot::mechanism;
using namespace knee_robot::dynamics;

namespace {

constexpr int kChains = 20, kStates = 50;

double uniform(std::mt19937& dice, double size) {
  return size * (2.0 * static_cast<double>(dice()) / 4294967296.0 - 1.0);
}

mechanism::Vector3 vector(std::mt19937& dice, double size) {
  return {uniform(dice, size), uniform(dice, size), uniform(dice, size)};
}

/// One to twelve joints; every third slides, every second has an axis of its frame.
mechanism::Chain randomChain(std::mt19937& dice) {
  mechanism::Chain chain;
  const int joints = 1 + static_cast<int>(dice() % 12);
  for (int j = 0; j < joints; ++j) {
    mechanism::ChainJoint joint;
    joint.prismatic = dice() % 3 == 0;
    joint.axis =
        dice() % 2 == 0 ? mechanism::Vector3(mechanism::Vector3::Unit(dice() % 3)) : vector(dice, 1.0).normalized();
    joint.origin.translation() = vector(dice, 0.5);
    joint.origin.linear() = Eigen::Quaterniond(vector(dice, 1.0).homogeneous()).normalized().matrix();
    chain.joints.push_back(joint);
  }
  return chain;
}

pin::JointModel jointModel(const mechanism::ChainJoint& joint) {
  const mechanism::Vector3& axis = joint.axis;
  if (axis == mechanism::Vector3::UnitX())
    return joint.prismatic ? pin::JointModel(pin::JointModelPX()) : pin::JointModelRX();
  if (axis == mechanism::Vector3::UnitY())
    return joint.prismatic ? pin::JointModel(pin::JointModelPY()) : pin::JointModelRY();
  if (axis == mechanism::Vector3::UnitZ())
    return joint.prismatic ? pin::JointModel(pin::JointModelPZ()) : pin::JointModelRZ();
  if (joint.prismatic) return pin::JointModelPrismaticUnaligned(axis);
  return pin::JointModelRevoluteUnaligned(axis);
}

pin::Model modelOf(const mechanism::Chain& chain) {
  pin::Model model;
  pin::JointIndex before = 0;
  for (const mechanism::ChainJoint& joint : chain.joints) {
    const pin::SE3 placement(joint.origin.linear(), joint.origin.translation());
    before = model.addJoint(before, jointModel(joint), placement, "joint_" + std::to_string(before));
  }
  return model;
}

/// Column of Pinocchio's ten parameters [m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz] where ours [Ixx, Ixy, Ixz, Iyy, Iyz,
/// Izz, m c, m] has one.
constexpr int kTheirs[] = {4, 5, 7, 6, 8, 9, 1, 2, 3, 0};

double difference(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& theirs) {
  double worst = 0.0;
  for (Eigen::Index c = 0; c < ours.cols(); ++c) {
    const Eigen::Index other = c / 10 * 10 + kTheirs[c % 10];
    worst = std::max(worst, (ours.col(c) - theirs.col(other)).cwiseAbs().maxCoeff());
  }
  return worst / std::max(1.0, ours.cwiseAbs().maxCoeff());
}

/// The arm of the tests with states to go round.
struct Arm {
  Arm() {
    std::vector<mechanism::ChainLimits> limits;
    chain =
        mechanism::readChain(std::string(KNEE_SOURCE_DIR) + "/test/dynamics/chain.urdf", "base", "tool", {}, limits);
    model = modelOf(chain);
    data = pin::Data(model);
    std::mt19937 dice(5);
    for (int k = 0; k < kStates; ++k) {
      for (auto* list : {&q, &v, &a}) {
        list->emplace_back(chain.size());
        for (double& value : list->back())
          value = uniform(dice, 2.0);
      }
    }
  }
  mechanism::Chain chain;
  pin::Model model;
  pin::Data data;
  std::vector<Eigen::VectorXd> q, v, a;
};

Arm& arm() {
  static Arm all;
  return all;
}

void ours(benchmark::State& state) {
  Arm& p = arm();
  dynamics::ChainRegressorData data(p.chain);
  std::size_t k = 0;
  for (auto _ : state) {
    const std::size_t i = k++ % kStates;
    dynamics::chainRegressor(p.chain, {0.0, 0.0, -9.81}, p.q[i], p.v[i], p.a[i], data);
    benchmark::DoNotOptimize(data.regressor.data());
  }
}
BENCHMARK(ours)->Name("chain_regressor");

void theirs(benchmark::State& state) {
  Arm& p = arm();
  std::size_t k = 0;
  for (auto _ : state) {
    const std::size_t i = k++ % kStates;
    benchmark::DoNotOptimize(pin::computeJointTorqueRegressor(p.model, p.data, p.q[i], p.v[i], p.a[i]).data());
  }
}
BENCHMARK(theirs)->Name("pinocchio_chain_regressor");

}  // namespace

/// Largest difference of the regressors' entries over random chains, of the largest entry.
double chainDisagreement() {
  std::mt19937 dice(4);
  double worst = 0.0;
  for (int n = 0; n < kChains; ++n) {
    const mechanism::Chain chain = randomChain(dice);
    const pin::Model model = modelOf(chain);
    pin::Data data(model);
    dynamics::ChainRegressorData own(chain);
    for (int k = 0; k < kStates; ++k) {
      Eigen::VectorXd q(chain.size()), v(chain.size()), a(chain.size());
      for (int j = 0; j < chain.size(); ++j) {
        q[j] = uniform(dice, 3.0);
        v[j] = uniform(dice, 2.0);
        a[j] = uniform(dice, 8.0);
      }
      dynamics::chainRegressor(chain, {0.0, 0.0, -9.81}, q, v, a, own);
      worst = std::max(worst, difference(own.regressor, pin::computeJointTorqueRegressor(model, data, q, v, a)));
    }
  }
  return worst;
}
