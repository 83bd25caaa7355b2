#include "knee_robot/dynamics/rigid_model.h"

namespace knee_robot::dynamics {
namespace {

BodyConstants constantsOf(const LinkParameters& p, const mechanism::Matrix3& to_frame) {
  mechanism::Matrix3 about_origin;
  about_origin << p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5];
  return {p[9], to_frame * p.segment<3>(6), to_frame * about_origin * to_frame.transpose()};
}

}  // namespace

RigidModel::RigidModel(const mechanism::Mechanism& m, const mechanism::Vector3& g, const RobotInertia& inertia)
    : RigidModel(m, g, toParameters(inertia)) {
  rotor_mass = inertia.rotor_mass;
}

RigidModel::RigidModel(const mechanism::Mechanism& m, const mechanism::Vector3& g, const InertialParameters& parameters)
    : mechanism(m), gravity(g), rotor_mass(mechanism::Vector4::Zero()) {
  mechanism::Matrix3 rod_to_leg;  // the leg basis is (x, z, -y) of the rod's frame
  rod_to_leg << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const auto body = [&](int link, const mechanism::Matrix3& to_frame) {
    return constantsOf(parameters.segment<kLinkParameters>(link * kLinkParameters), to_frame);
  };
  for (int i = 0; i < mechanism::kLegs; ++i) {
    cylinders[i] = body(cylinderLink(i), mechanism::Matrix3::Identity());
    rods[i] = body(rodLink(i), rod_to_leg);
    leg_inertias[i] = cylinders[i].inertia + rods[i].inertia;
  }
  platform = body(kPlatformLink, mechanism::Matrix3::Identity());
}

}  // namespace knee_robot::dynamics
