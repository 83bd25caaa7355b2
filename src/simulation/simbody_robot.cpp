#include "knee_robot/simulation/simbody_robot.h"

#include <Simbody.h>

#include <Eigen/LU>
#include <Eigen/QR>

#include "knee_robot/base/constants.h"

namespace knee_robot::simulation {
namespace {

constexpr int kClosures = 9;  ///< three ball constraints

using SpatialForces = SimTK::Vector_<SimTK::SpatialVec>;

SimTK::Rotation rotation(const SimTK::Vec3& x, const SimTK::Vec3& y) {
  const SimTK::Vec3 z = x % y;
  return SimTK::Rotation(SimTK::Mat33(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]));
}

SimTK::MassProperties properties(const dynamics::LinkInertia& link) {
  const SimTK::Vec3 center(link.center[0], link.center[1], link.center[2]);
  const mechanism::Matrix3& t = link.inertia;
  const SimTK::Inertia central(t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(0, 2), t(1, 2));
  return {link.mass, center, central.shiftFromMassCenter(-center, link.mass)};
}

SimTK::Vec3 vec3(const mechanism::Vector3& v) {
  return {v[0], v[1], v[2]};
}

/// Our 15 coordinates in the order of Simbody's joints; theta_4 counts from the leg, `offset` (pi/2 for positions, else
/// 0) away.
SimTK::Vector inJointOrder(const mechanism::Coordinates& c, double offset) {
  SimTK::Vector v(mechanism::kUrdfJoints);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k)
      v[3 * i + k] = c[3 * i + 2 - k];
  }
  v[9] = c[10];
  v[10] = c[9];
  v[11] = c[12] + c[10] - offset;
  v[12] = c[11];
  return v;
}

JointVector toEigen(const SimTK::Vector& v) {
  JointVector result;
  for (int i = 0; i < mechanism::kUrdfJoints; ++i)
    result[i] = v[i];
  return result;
}

}  // namespace

struct SimbodyRobot::System {
  System(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
         const dynamics::RobotInertia& inertia);

  /// Columns of the constraint matrix: of the nine dependent joints, and of the four actuated ones.
  struct Split {
    Eigen::Matrix<double, kClosures, kClosures> dependent;
    Eigen::Matrix<double, kClosures, mechanism::kLegs> actuated;
  };
  Split constraintMatrix() const;
  mechanism::Vector4 project(const SimTK::Vector& residual) const;
  SimTK::Vector withActuatorForces(const mechanism::Vector4& forces) const;

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  SimTK::Force::UniformGravity gravity;
  std::array<SimTK::MobilizedBody, mechanism::kLegs> cylinders, rods;
  SimTK::MobilizedBody platform;
  std::array<SimTK::Constraint, 3> balls;
  SimTK::State state;
  SimTK::Vector acceleration;
};

SimbodyRobot::System::System(const mechanism::Mechanism& mechanism, const mechanism::Vector3& g,
                             const dynamics::RobotInertia& inertia)
    : matter(system), forces(system), gravity(forces, matter, vec3(g)) {
  using SimTK::MobilizedBody;
  using SimTK::Transform;
  const SimTK::Vec3 ex(1, 0, 0), ey(0, 1, 0), ez(0, 0, 1);
  // Slider: Simbody slides along x. In the cylinder that is y (along the leg), in the rod z; both share the frame's x.
  const Transform slide_cylinder(rotation(ey, ex)), slide_rod(rotation(ez, ex));
  for (std::size_t i = 0; i < mechanism::kLegs; ++i) {
    const int leg = static_cast<int>(i);
    const SimTK::Body::Rigid cylinder(properties(inertia.links[static_cast<std::size_t>(dynamics::cylinderLink(leg))]));
    const SimTK::Body::Rigid rod(properties(inertia.links[static_cast<std::size_t>(dynamics::rodLink(leg))]));
    const SimTK::Vec3 base = vec3(mechanism.base_points[i]);
    if (i < 3) {
      // Universal: about F's x (base -Y), then about the turned y (n: base Z at q1 = 0).
      cylinders[i] = MobilizedBody::Universal(matter.Ground(), Transform(rotation(-ey, ez), base), cylinder,
                                              Transform(rotation(ex, ez)));
    } else {
      cylinders[i] = MobilizedBody::Pin(matter.Ground(), Transform(rotation(-ez, ex), base), cylinder, Transform());
    }
    rods[i] = MobilizedBody::Slider(cylinders[i], slide_cylinder, rod, slide_rod);
  }
  const SimTK::Body::Rigid plate(properties(inertia.links[dynamics::kPlatformLink]));
  const Transform turn(rotation(ey, ez));  // theta about the rod's y, then psi about z
  platform = MobilizedBody::Universal(rods[3], turn, plate, turn);
  for (std::size_t i = 0; i < 3; ++i)
    balls[i] = SimTK::Constraint::Ball(rods[i], SimTK::Vec3(0), platform, vec3(mechanism.platform_points[i]));
  state = system.realizeTopology();
  system.realizeModel(state);
  acceleration.resize(mechanism::kUrdfJoints);
  acceleration = 0.0;
}

SimbodyRobot::System::Split SimbodyRobot::System::constraintMatrix() const {
  SimTK::Matrix g;
  matter.calcG(state, g);
  Split split;
  int actuated = 0, dependent = 0;
  for (int joint = 0; joint < mechanism::kUrdfJoints; ++joint) {
    const bool is_actuated =
        actuated < mechanism::kLegs && joint == kActuatedJoints[static_cast<std::size_t>(actuated)];
    for (int row = 0; row < kClosures; ++row)
      (is_actuated ? split.actuated(row, actuated) : split.dependent(row, dependent)) = g(row, joint);
    ++(is_actuated ? actuated : dependent);
  }
  return split;
}

mechanism::Vector4 SimbodyRobot::System::project(const SimTK::Vector& residual) const {
  const Split g = constraintMatrix();
  const Eigen::Matrix<double, kClosures, mechanism::kLegs> x = g.dependent.partialPivLu().solve(g.actuated);
  mechanism::Vector4 actuated;
  Eigen::Matrix<double, kClosures, 1> dependent;
  int a = 0, d = 0;
  for (int joint = 0; joint < mechanism::kUrdfJoints; ++joint) {
    if (a < mechanism::kLegs && joint == kActuatedJoints[static_cast<std::size_t>(a)]) {
      actuated[a++] = residual[joint];
    } else {
      dependent[d++] = residual[joint];
    }
  }
  return actuated - x.transpose() * dependent;
}

SimTK::Vector SimbodyRobot::System::withActuatorForces(const mechanism::Vector4& actuator_forces) const {
  SimTK::Vector mobility(mechanism::kUrdfJoints, 0.0);
  for (int i = 0; i < mechanism::kLegs; ++i)
    mobility[kActuatedJoints[static_cast<std::size_t>(i)]] = actuator_forces[i];
  return mobility;
}

SimbodyRobot::SimbodyRobot(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                           const dynamics::RobotInertia& inertia)
    : system_(std::make_unique<System>(mechanism, gravity, inertia)) {}

SimbodyRobot::~SimbodyRobot() = default;

void SimbodyRobot::set(const mechanism::CoordinateMotion& motion) {
  system_->state.updQ() = inJointOrder(motion.position, kPi / 2);
  system_->state.updU() = inJointOrder(motion.velocity, 0.0);
  system_->system.realize(system_->state, SimTK::Stage::Dynamics);
}

bool SimbodyRobot::follow(const AxisMotion& motion) {
  constexpr int kRounds = 30;
  constexpr double kClosed_m = 1e-13;
  constexpr double kDone_m = 1e-10;
  System& s = *system_;
  const auto setDependent = [](SimTK::Vector& v, const Eigen::Matrix<double, kClosures, 1>& values, bool add) {
    int a = 0, d = 0;
    for (int joint = 0; joint < mechanism::kUrdfJoints; ++joint) {
      if (a < mechanism::kLegs && joint == kActuatedJoints[static_cast<std::size_t>(a)]) {
        ++a;
      } else {
        v[joint] = values[d++] + (add ? v[joint] : 0.0);
      }
    }
  };
  const auto setActuated = [](SimTK::Vector& v, const mechanism::Vector4& values) {
    for (int i = 0; i < mechanism::kLegs; ++i)
      v[kActuatedJoints[static_cast<std::size_t>(i)]] = values[i];
  };
  setActuated(s.state.updQ(), motion.position);
  double open = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    s.system.realize(s.state, SimTK::Stage::Position);
    Eigen::Matrix<double, kClosures, 1> error;
    for (int row = 0; row < kClosures; ++row)
      error[row] = s.state.getQErr()[row];
    const double before = open;
    open = error.cwiseAbs().maxCoeff();
    if (!(open < 1.0)) return false;
    if (open < kClosed_m || (round > 3 && open < kDone_m && open >= 0.5 * before)) break;  // rounding is reached
    if (round + 1 == kRounds) return false;
    // Rates of universals, pins and sliders are the derivatives of their coordinates, so the velocity matrix serves
    // here too.
    setDependent(s.state.updQ(), s.constraintMatrix().dependent.partialPivLu().solve(-error), true);
  }
  const System::Split g = s.constraintMatrix();
  const Eigen::PartialPivLU<Eigen::Matrix<double, kClosures, kClosures>> lu(g.dependent);
  setActuated(s.state.updU(), motion.velocity);
  setDependent(s.state.updU(), lu.solve(-g.actuated * motion.velocity), false);
  s.system.realize(s.state, SimTK::Stage::Velocity);
  SimTK::Vector bias;
  s.matter.calcBiasForAccelerationConstraints(s.state, bias);
  Eigen::Matrix<double, kClosures, 1> velocity_terms;
  for (int row = 0; row < kClosures; ++row)
    velocity_terms[row] = bias[row];
  setActuated(s.acceleration, motion.acceleration);
  setDependent(s.acceleration, lu.solve(-g.actuated * motion.acceleration - velocity_terms), false);
  s.system.realize(s.state, SimTK::Stage::Dynamics);
  return toEigen(s.acceleration).allFinite();
}

JointVector SimbodyRobot::positions() const {
  return toEigen(system_->state.getQ());
}

JointVector SimbodyRobot::rates() const {
  return toEigen(system_->state.getU());
}

std::array<mechanism::Vector3, 3> SimbodyRobot::sphericalRates() const {
  std::array<mechanism::Vector3, 3> rates;
  const SimTK::Vec3 platform = system_->platform.getBodyAngularVelocity(system_->state);
  for (std::size_t i = 0; i < 3; ++i) {
    const SimTK::Vec3 relative = platform - system_->rods[i].getBodyAngularVelocity(system_->state);
    rates[i] = mechanism::Vector3(relative[0], relative[1], relative[2]);
  }
  return rates;
}

mechanism::Vector4 SimbodyRobot::actuatorAccelerations(const mechanism::Vector4& actuator_forces) {
  System& s = *system_;
  s.system.realize(s.state, SimTK::Stage::Dynamics);
  const SimTK::Vector mobility =
      s.system.getMobilityForces(s.state, SimTK::Stage::Dynamics) + s.withActuatorForces(actuator_forces);
  SpatialForces body_accelerations;
  s.matter.calcAcceleration(s.state, mobility, s.system.getRigidBodyForces(s.state, SimTK::Stage::Dynamics),
                            s.acceleration, body_accelerations);
  mechanism::Vector4 result;
  for (int i = 0; i < mechanism::kLegs; ++i)
    result[i] = s.acceleration[kActuatedJoints[static_cast<std::size_t>(i)]];
  return result;
}

std::array<mechanism::Vector3, 3> SimbodyRobot::ballForces(const mechanism::Vector4& actuator_forces) const {
  const System& s = *system_;
  // M udot + G^T lambda = f: what the tree lacks is the constraints' share.
  SimTK::Vector residual;
  s.matter.calcResidualForceIgnoringConstraints(s.state, s.withActuatorForces(actuator_forces),
                                                s.system.getRigidBodyForces(s.state, SimTK::Stage::Dynamics),
                                                s.acceleration, residual);
  SimTK::Matrix g;
  s.matter.calcG(s.state, g);
  Eigen::Matrix<double, mechanism::kUrdfJoints, kClosures> transposed;
  for (int joint = 0; joint < mechanism::kUrdfJoints; ++joint) {
    for (int row = 0; row < kClosures; ++row)
      transposed(joint, row) = g(row, joint);
  }
  const Eigen::Matrix<double, kClosures, 1> lambda = transposed.colPivHouseholderQr().solve(-toEigen(residual));
  std::array<mechanism::Vector3, 3> result;
  for (std::size_t i = 0; i < 3; ++i)  // multipliers are in the frame of the common ancestor, the base
    result[i] = lambda.segment<3>(3 * static_cast<Eigen::Index>(i));
  return result;
}

mechanism::Vector4 SimbodyRobot::actuatorForces(const mechanism::CoordinateMotion& motion) {
  system_->acceleration = inJointOrder(motion.acceleration, 0.0);
  return actuatorForces(JointVector::Zero(),
                        {mechanism::Vector3::Zero(), mechanism::Vector3::Zero(), mechanism::Vector3::Zero()});
}

mechanism::Vector4 SimbodyRobot::actuatorForces(const JointVector& joint_forces,
                                                const std::array<mechanism::Vector3, 3>& spherical_torques) {
  System& s = *system_;
  s.system.realize(s.state, SimTK::Stage::Dynamics);
  SpatialForces bodies = s.system.getRigidBodyForces(s.state, SimTK::Stage::Dynamics);
  for (std::size_t i = 0; i < 3; ++i) {
    bodies[s.platform.getMobilizedBodyIndex()][0] += vec3(spherical_torques[i]);
    bodies[s.rods[i].getMobilizedBodyIndex()][0] -= vec3(spherical_torques[i]);
  }
  SimTK::Vector mobility(mechanism::kUrdfJoints);
  for (int joint = 0; joint < mechanism::kUrdfJoints; ++joint)
    mobility[joint] = joint_forces[joint];
  SimTK::Vector residual;
  s.matter.calcResidualForceIgnoringConstraints(s.state, mobility, bodies, s.acceleration, residual);
  return s.project(residual);
}

double SimbodyRobot::kineticEnergy() const {
  return system_->system.calcKineticEnergy(system_->state);
}

double SimbodyRobot::energy() const {
  return system_->system.calcEnergy(system_->state);
}

}  // namespace knee_robot::simulation
