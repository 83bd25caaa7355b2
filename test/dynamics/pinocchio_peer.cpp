// Pinocchio on the same robot and states as the program `benchmark`. Compiled by scripts/benchmark_peers against the
// headers of the PyPI wheel `pin`, not by CMake. Checks that Pinocchio agrees with the project's dynamics before it
// times anything.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/multibody.hpp>

#include "knee_robot/dynamics/forward_dynamics.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/mechanism/constraints.h"
#include "test/dynamics/peer_states.h"
#include "test/mechanism/configured_robot.h"

namespace pin = pinocchio;
using namespace knee_robot;
using namespace knee_robot::mechanism;
using namespace knee_robot::dynamics;

double chainDisagreement();  // pinocchio_chain_peer.cpp

namespace {

pin::Inertia inertiaOf(const LinkInertia& link) {
  return {link.mass, link.center, link.inertia};
}

mechanism::Matrix3 columns(const mechanism::Vector3& x, const mechanism::Vector3& y, const mechanism::Vector3& z) {
  mechanism::Matrix3 m;
  m << x, y, z;
  return m;
}

/// The tree of the URDF: every leg to its tip, leg 4 with the platform.
struct Peer {
  Peer() {
    const mechanism::Robot robot = mechanism::configuredRobot("final");
    mechanism = std::make_unique<Mechanism>(*robot.mechanism);
    inertia = loadRobotInertia(robot);
    build();
    for (const Motion& m : peerMotions(*mechanism)) {
      motions.push_back(m);
      const CoordinateMotion all = coordinateMotion(*mechanism, m);
      q.push_back(order(all.position, M_PI / 2));
      v.push_back(order(all.velocity, 0.0));
      a.push_back(order(all.acceleration, 0.0));
    }
    data = std::make_unique<pin::Data>(model);
    pin::initConstraintDynamics(model, *data, loops, loop_data);
    settings.max_iter = 1;
    settings.mu = 0.0;
  }

  void build() {
    const mechanism::Vector3 ex = Vector3::UnitX(), ey = Vector3::UnitY(), ez = Vector3::UnitZ();
    const pin::SE3 rod(columns(ex, -ez, ey), Vector3::Zero());
    std::array<pin::JointIndex, kLegs> tips;
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const std::string k = std::to_string(i + 1);
      pin::JointIndex cylinder;
      if (i < 3) {
        const auto cross = model.addJoint(0, pin::JointModelRevoluteUnaligned(-ey),
                                          pin::SE3(Matrix3::Identity(), mechanism->base_points[i]), "q" + k + "1");
        cylinder =
            model.addJoint(cross, pin::JointModelRZ(), pin::SE3(columns(-ey, ex, ez), Vector3::Zero()), "q" + k + "2");
      } else {
        cylinder =
            model.addJoint(0, pin::JointModelRZ(), pin::SE3(columns(-ez, ex, -ey), mechanism->base_points[i]), "q41");
      }
      model.appendBodyToJoint(cylinder, inertiaOf(inertia.links[cylinderLink(i)]));
      tips[i] = model.addJoint(cylinder, pin::JointModelPZ(), rod, i < 3 ? "q" + k + "3" : "q42");
      model.appendBodyToJoint(tips[i], inertiaOf(inertia.links[rodLink(i)]));
    }
    const auto cross = model.addJoint(tips[3], pin::JointModelRY(), pin::SE3::Identity(), "theta_4");
    const auto platform = model.addJoint(cross, pin::JointModelRZ(), pin::SE3::Identity(), "psi_4");
    model.appendBodyToJoint(platform, inertiaOf(inertia.links[kPlatformLink]));
    for (int i = 0; i < 3; ++i) {
      loops.emplace_back(pin::CONTACT_3D, model, tips[i], pin::SE3::Identity(), platform,
                         pin::SE3(Matrix3::Identity(), mechanism->platform_points[i]), pin::LOCAL);
      loop_data.emplace_back(loops.back());
    }
  }

  static Eigen::VectorXd order(const Coordinates& c, double offset) {
    Eigen::VectorXd x(13);
    x << c[2], c[1], c[0], c[5], c[4], c[3], c[8], c[7], c[6], c[10], c[9], c[12] + c[10] - offset, c[11];
    return x;
  }

  const Eigen::VectorXd& forward(std::size_t k, const Eigen::VectorXd& tau) {
    return pin::constraintDynamics(model, *data, q[k], v[k], tau, loops, loop_data, settings);
  }

  /// Largest relative difference of the actuators' accelerations from the project's.
  double disagreement() {
    const dynamics::RigidModel ours(*mechanism, Vector3(0, 0, -9.81), inertia);
    double worst = 0.0;
    for (std::size_t k = 0; k < dynamics::kPeerStates; ++k) {
      dynamics::ForwardDynamicsData d;
      const mechanism::Motion& m = motions[k];
      dynamics::forwardDynamics(ours, m.pose, m.pose_velocity, mechanism::Vector4::Constant(50.0), d);
      const mechanism::Vector4 expected = d.jacobian * d.acceleration + lengthBias(*mechanism, m.pose, m.pose_velocity);
      const Eigen::VectorXd& got = forward(k, force());
      worst = std::max(worst, (Vector4(got[2], got[5], got[8], got[10]) - expected).norm() / expected.norm());
    }
    return worst;
  }

  static Eigen::VectorXd force() {
    Eigen::VectorXd tau = Eigen::VectorXd::Zero(13);
    for (int j : {2, 5, 8, 10})
      tau[j] = 50.0;
    return tau;
  }

  std::unique_ptr<Mechanism> mechanism;
  dynamics::RobotInertia inertia;
  pin::Model model;
  std::unique_ptr<pin::Data> data;
  std::vector<pin::RigidConstraintModel, Eigen::aligned_allocator<pin::RigidConstraintModel>> loops;
  std::vector<pin::RigidConstraintData, Eigen::aligned_allocator<pin::RigidConstraintData>> loop_data;
  pin::ProximalSettings settings;
  std::vector<Motion> motions;
  std::vector<Eigen::VectorXd> q, v, a;
};

Peer& peer() {
  static Peer all;
  return all;
}

void forwardDynamicsCase(benchmark::State& state) {
  Peer& p = peer();
  const Eigen::VectorXd tau = Peer::force();
  std::size_t k = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(p.forward(k++ % kPeerStates, tau).data());
}
BENCHMARK(forwardDynamicsCase)->Name("pinocchio_constrained_forward_dynamics");

void regressorCase(benchmark::State& state) {
  Peer& p = peer();
  std::size_t k = 0;
  for (auto _ : state) {
    const std::size_t i = k++ % dynamics::kPeerStates;
    benchmark::DoNotOptimize(pin::computeJointTorqueRegressor(p.model, *p.data, p.q[i], p.v[i], p.a[i]).data());
  }
}
BENCHMARK(regressorCase)->Name("pinocchio_tree_regressor");

}  // namespace

int main(int argc, char** argv) {
  const double worst = peer().disagreement();
  std::fprintf(stderr, "pinocchio: largest relative difference of the actuators' accelerations over %zu states: %.1e\n",
               dynamics::kPeerStates, worst);
  const double chains = chainDisagreement();
  std::fprintf(stderr, "pinocchio: largest difference of chains' regressors, of their largest entry: %.1e\n", chains);
  if (!(worst < 1e-6) || !(chains < 1e-10)) return 1;
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
