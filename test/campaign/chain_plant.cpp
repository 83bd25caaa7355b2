// chain_plant ROBOT MOTION OUTPUT: joint torques of an open chain in Simbody, for scripts/injection_campaign --chain.
// Its tree is built of the links that the URDF names, one body each, with Simbody's own joints; no kinematics or
// dynamics of this project.
// MOTION: rows of position, velocity, acceleration of all joints (rad or m), no header. OUTPUT: torques, a row each.
#include <Simbody.h>

#include <fstream>
#include <sstream>

#include "knee_robot/mechanism/robot.h"

namespace {

using namespace knee_robot;
using SimTK::Vec3;

Vec3 vec3(const mechanism::Vector3& v) {
  return {v[0], v[1], v[2]};
}

SimTK::Rotation rotation(const mechanism::Matrix3& m) {
  return SimTK::Rotation(SimTK::Mat33(m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)));
}

/// Sum of the links of one body.
SimTK::MassProperties propertiesOf(const mechanism::ChainJoint& joint) {
  double mass = 0.0;
  Vec3 moment(0);
  SimTK::Inertia inertia(0.0);
  for (const mechanism::ChainLink& link : joint.links) {
    const Vec3 center = vec3(link.center);
    const mechanism::Matrix3& t = link.inertia;
    const SimTK::Inertia central(t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(0, 2), t(1, 2));
    inertia += central.shiftFromMassCenter(-center, link.mass);
    mass += link.mass;
    moment += link.mass * center;
  }
  return {mass, moment / mass, inertia};
}

class Plant {
 public:
  explicit Plant(const mechanism::Robot& robot)
      : matter_(system_), forces_(system_), gravity_(forces_, matter_, vec3(robot.gravity)) {
    SimTK::MobilizedBody parent = matter_.Ground();
    for (const mechanism::ChainJoint& joint : robot.chain->joints) {
      const SimTK::Body::Rigid body(propertiesOf(joint));
      // Simbody's pin turns about z, its slider goes along x.
      const SimTK::Rotation along(SimTK::UnitVec3(vec3(joint.axis)), joint.prismatic
                                                                         ? SimTK::CoordinateAxis(SimTK::XAxis)
                                                                         : SimTK::CoordinateAxis(SimTK::ZAxis));
      const SimTK::Transform there(rotation(joint.origin.linear()) * along, vec3(joint.origin.translation())),
          here(along);
      if (joint.prismatic) {
        parent = SimTK::MobilizedBody::Slider(parent, there, body, here);
      } else {
        parent = SimTK::MobilizedBody::Pin(parent, there, body, here);
      }
    }
    state_ = system_.realizeTopology();
    system_.realizeModel(state_);
  }

  SimTK::Vector torques(const std::vector<double>& row, int n) {
    SimTK::Vector acceleration(n), residual;
    for (int i = 0; i < n; ++i) {
      state_.updQ()[i] = row[static_cast<std::size_t>(i)];
      state_.updU()[i] = row[static_cast<std::size_t>(n + i)];
      acceleration[i] = row[static_cast<std::size_t>(2 * n + i)];
    }
    system_.realize(state_, SimTK::Stage::Dynamics);
    matter_.calcResidualForceIgnoringConstraints(state_, SimTK::Vector(n, 0.0),
                                                 system_.getRigidBodyForces(state_, SimTK::Stage::Dynamics),
                                                 acceleration, residual);
    return residual;
  }

 private:
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::UniformGravity gravity_;
  SimTK::State state_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const mechanism::Robot robot = mechanism::loadAnyRobot(argv[1]);
  Plant plant(robot);
  const int n = robot.axes();
  std::ifstream in(argv[2]);
  std::ofstream out(argv[3]);
  out.precision(12);
  for (std::string line; std::getline(in, line);) {
    std::istringstream text(line);
    std::vector<double> row;
    for (double value; text >> value;)
      row.push_back(value);
    if (static_cast<int>(row.size()) != 3 * n) return 2;
    const SimTK::Vector torque = plant.torques(row, n);
    for (int i = 0; i < n; ++i)
      out << (i > 0 ? " " : "") << torque[i];
    out << "\n";
  }
  return out ? 0 : 1;
}
