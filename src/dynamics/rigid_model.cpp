#include "knee_robot/dynamics/rigid_model.h"

namespace knee_robot::dynamics {
namespace {

BodyConstants constantsOf(const LinkInertia& link, const mechanism::Matrix3& to_frame) {
  const LinkParameters p = toParameters(link);
  mechanism::Matrix3 about_origin;
  about_origin << p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5];
  return {p[9], to_frame * p.segment<3>(6), to_frame * about_origin * to_frame.transpose()};
}

}  // namespace

RigidModel::RigidModel(const mechanism::Mechanism& m, const mechanism::Vector3& g, const RobotInertia& inertia)
    : mechanism(m), gravity(g), rotor_mass(inertia.rotor_mass) {
  mechanism::Matrix3 rod_to_leg;  // the leg basis is (x, z, -y) of the rod's frame
  rod_to_leg << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    cylinders[i] = constantsOf(inertia.links[cylinderLink(i)], mechanism::Matrix3::Identity());
    rods[i] = constantsOf(inertia.links[rodLink(i)], rod_to_leg);
    leg_inertias[i] = cylinders[i].inertia + rods[i].inertia;
  }
  platform = constantsOf(inertia.links[kPlatformLink], mechanism::Matrix3::Identity());
}

}  // namespace knee_robot::dynamics
