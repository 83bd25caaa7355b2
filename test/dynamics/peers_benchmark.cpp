// Simbody and KDL on the same robot and states as the program `benchmark`. Their results are checked in simbody_test
// and opened_leg_test; here they are timed.
#include <benchmark/benchmark.h>

#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include "knee_robot/simulation/simbody_robot.h"
#include "test/dynamics/peer_states.h"
#include "test/mechanism/configured_robot.h"

namespace {

using namespace knee_robot;

struct Peers {
  Peers()
      : robot(mechanism::configuredRobot("final")),
        simbody(*robot.mechanism, robot.gravity, dynamics::loadRobotInertia(robot)) {
    for (const mechanism::Motion& m : dynamics::peerMotions(*robot.mechanism))
      motions.push_back(mechanism::coordinateMotion(*robot.mechanism, m));
  }
  mechanism::Robot robot;
  simulation::SimbodyRobot simbody;
  std::vector<mechanism::CoordinateMotion> motions;
};

Peers& peers() {
  static Peers all;
  return all;
}

void simbodyInverse(benchmark::State& state) {
  Peers& p = peers();
  std::size_t k = 0;
  for (auto _ : state) {
    const mechanism::CoordinateMotion& m = p.motions[k++ % dynamics::kPeerStates];
    p.simbody.set(m);
    benchmark::DoNotOptimize(p.simbody.actuatorForces(m));
  }
}
BENCHMARK(simbodyInverse)->Name("simbody_inverse_dynamics");

void simbodyForward(benchmark::State& state) {
  Peers& p = peers();
  const mechanism::Vector4 forces = mechanism::Vector4::Constant(50.0);
  std::size_t k = 0;
  for (auto _ : state) {
    p.simbody.set(p.motions[k++ % dynamics::kPeerStates]);
    benchmark::DoNotOptimize(p.simbody.actuatorAccelerations(forces));
  }
}
BENCHMARK(simbodyForward)->Name("simbody_forward_dynamics");

void kdlLeg(benchmark::State& state) {
  Peers& p = peers();
  KDL::Tree tree;
  KDL::Chain chain;
  kdl_parser::treeFromFile(p.robot.urdf, tree);
  tree.getChain("base", "leg_1_rod", chain);
  KDL::ChainIdSolver_RNE solver(chain, KDL::Vector(0, 0, -9.81));
  const KDL::Wrenches none(chain.getNrOfSegments(), KDL::Wrench::Zero());
  KDL::JntArray q(3), v(3), a(3), torque(3);
  std::size_t k = 0;
  for (auto _ : state) {
    const mechanism::CoordinateMotion& m = p.motions[k++ % dynamics::kPeerStates];
    for (int j = 0; j < 3; ++j) {
      q(j) = m.position[2 - j];
      v(j) = m.velocity[2 - j];
      a(j) = m.acceleration[2 - j];
    }
    solver.CartToJnt(q, v, a, none, torque);
    benchmark::DoNotOptimize(torque.data);
  }
}
BENCHMARK(kdlLeg)->Name("kdl_newton_euler_one_leg");

}  // namespace

BENCHMARK_MAIN();
