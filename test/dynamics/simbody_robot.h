#pragma once

// The robot as a Simbody multibody system: the same link inertias, its own joints, loops closed by ball constraints.
#include <Simbody.h>

#include <array>
#include <memory>

#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/mechanism/constraints.h"

namespace knee_robot {

class SimbodyRobot {
 public:
  SimbodyRobot(const Mechanism& mechanism, const Vector3& gravity, const RobotInertia& inertia)
      : matter_(system_),
        forces_(system_),
        gravity_(forces_, matter_, SimTK::Vec3(gravity.x(), gravity.y(), gravity.z())) {
    using SimTK::Transform;
    const auto rotation = [](const SimTK::Vec3& x, const SimTK::Vec3& y) {
      return SimTK::Rotation(SimTK::Mat33(x[0], y[0], (x % y)[0], x[1], y[1], (x % y)[1], x[2], y[2], (x % y)[2]));
    };
    const SimTK::Vec3 ex(1, 0, 0), ey(0, 1, 0), ez(0, 0, 1);
    // Slider: Simbody slides along x. In the cylinder that is y (along the leg), in the rod z; both share the frame's x.
    const Transform slide_cylinder(rotation(ey, ex)), slide_rod(rotation(ez, ex));
    for (int i = 0; i < kLegs; ++i) {
      const SimTK::Body::Rigid cylinder(properties(inertia.links[cylinderLink(i)]));
      const SimTK::Body::Rigid rod(properties(inertia.links[rodLink(i)]));
      const SimTK::Vec3 base(mechanism.base_points[i][0], mechanism.base_points[i][1], mechanism.base_points[i][2]);
      if (i < 3) {
        // Universal: about F's x (base -Y), then about the turned y (n: base Z at q1 = 0).
        cylinders_[i] = SimTK::MobilizedBody::Universal(matter_.Ground(), Transform(rotation(-ey, ez), base), cylinder,
                                                        Transform(rotation(ex, ez)));
      } else {
        cylinders_[i] =
            SimTK::MobilizedBody::Pin(matter_.Ground(), Transform(rotation(-ez, ex), base), cylinder, Transform());
      }
      rods_[i] = SimTK::MobilizedBody::Slider(cylinders_[i], slide_cylinder, rod, slide_rod);
    }
    const SimTK::Body::Rigid plate(properties(inertia.links[kPlatformLink]));
    const Transform turn(rotation(ey, ez));  // theta about the rod's y, then psi about z
    platform_ = SimTK::MobilizedBody::Universal(rods_[3], turn, plate, turn);
    for (int i = 0; i < 3; ++i) {
      const Vector3& p = mechanism.platform_points[i];
      balls_[i] = SimTK::Constraint::Ball(rods_[i], SimTK::Vec3(0), platform_, SimTK::Vec3(p[0], p[1], p[2]));
    }
    state_ = system_.realizeTopology();
    system_.realizeModel(state_);
  }

  /// Joint coordinates in Simbody's order: q11 q12 q13 ... q41 q42 theta_4 psi_4, as SimTK::Vector.
  static SimTK::Vector order(const Coordinates& c, double offset) {
    SimTK::Vector v(13);
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

  void set(const CoordinateMotion& motion) {
    state_.updQ() = order(motion.position, M_PI / 2);
    state_.updU() = order(motion.velocity, 0.0);
  }

  /// Accelerations of the four actuators under these actuator forces.
  Vector4 actuatorAccelerations(const Vector4& actuator_forces) {
    SimTK::Vector mobility(13, 0.0);
    for (int i = 0; i < kLegs; ++i)
      mobility[kSlider[i]] = actuator_forces[i];
    system_.realize(state_, SimTK::Stage::Dynamics);
    SimTK::Vector all = system_.getMobilityForces(state_, SimTK::Stage::Dynamics) + mobility;
    const SimTK::Vector_<SimTK::SpatialVec>& bodies = system_.getRigidBodyForces(state_, SimTK::Stage::Dynamics);
    SimTK::Vector_<SimTK::SpatialVec> body_accelerations;
    matter_.calcAcceleration(state_, all, bodies, udot_, body_accelerations);
    return {udot_[kSlider[0]], udot_[kSlider[1]], udot_[kSlider[2]], udot_[kSlider[3]]};
  }

  /// Actuator forces for these accelerations: Simbody's tree residual, projected by its own constraint matrix G.
  Vector4 actuatorForces(const CoordinateMotion& motion) {
    system_.realize(state_, SimTK::Stage::Dynamics);
    const SimTK::Vector udot = order(motion.acceleration, 0.0);
    const SimTK::Vector_<SimTK::SpatialVec>& bodies = system_.getRigidBodyForces(state_, SimTK::Stage::Dynamics);
    SimTK::Vector residual;
    matter_.calcResidualForceIgnoringConstraints(state_, SimTK::Vector(13, 0.0), bodies, udot, residual);
    SimTK::Matrix g;
    matter_.calcG(state_, g);
    Eigen::Matrix<double, 9, 9> dependent;
    Eigen::Matrix<double, 9, 4> independent;
    int filled = 0;
    for (int j = 0, a = 0; j < 13; ++j) {
      const bool actuated = a < kLegs && j == kSlider[a];
      for (int row = 0; row < 9; ++row)
        (actuated ? independent(row, a) : dependent(row, filled)) = g(row, j);
      actuated ? ++a : ++filled;
    }
    const Eigen::Matrix<double, 9, 4> x = dependent.partialPivLu().solve(independent);
    Vector4 forces;
    Eigen::Matrix<double, 9, 1> bound;
    filled = 0;
    for (int j = 0, a = 0; j < 13; ++j) {
      if (a < kLegs && j == kSlider[a]) {
        forces[a++] = residual[j];
      } else {
        bound[filled++] = residual[j];
      }
    }
    return forces - x.transpose() * bound;
  }

  /// Forces of the platform on the tips of legs 1 to 3 (base frame), from Simbody's multipliers in the last acceleration.
  std::array<Vector3, 3> ballForces(const Vector4& actuator_forces) {
    SimTK::Vector mobility(13, 0.0);
    for (int i = 0; i < kLegs; ++i)
      mobility[kSlider[i]] = actuator_forces[i];
    const SimTK::Vector_<SimTK::SpatialVec>& bodies = system_.getRigidBodyForces(state_, SimTK::Stage::Dynamics);
    // M udot + G^T lambda = f: what the tree lacks is the constraints' share.
    SimTK::Vector residual;
    matter_.calcResidualForceIgnoringConstraints(state_, mobility, bodies, udot_, residual);
    SimTK::Matrix g;
    matter_.calcG(state_, g);
    Eigen::Matrix<double, 13, 9> transposed;
    Eigen::Matrix<double, 13, 1> missing;
    for (int j = 0; j < 13; ++j) {
      missing[j] = -residual[j];
      for (int row = 0; row < 9; ++row)
        transposed(j, row) = g(row, j);
    }
    const Eigen::Matrix<double, 9, 1> lambda = transposed.colPivHouseholderQr().solve(missing);
    std::array<Vector3, 3> forces;
    for (int i = 0; i < 3; ++i) {
      // Multipliers are in the frame of the common ancestor (the base); -G^T lambda acts on the joints.
      forces[i] = Vector3(lambda[3 * i], lambda[3 * i + 1], lambda[3 * i + 2]);
    }
    return forces;
  }

  double energy() {
    system_.realize(state_, SimTK::Stage::Dynamics);
    return system_.calcEnergy(state_);
  }
  double kineticEnergy() {
    system_.realize(state_, SimTK::Stage::Dynamics);
    return system_.calcKineticEnergy(state_);
  }

 private:
  static constexpr std::array<int, kLegs> kSlider = {2, 5, 8, 10};

  static SimTK::MassProperties properties(const LinkInertia& link) {
    const SimTK::Vec3 center(link.center[0], link.center[1], link.center[2]);
    const Matrix3& t = link.inertia;
    const SimTK::Inertia central(t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(0, 2), t(1, 2));
    return {link.mass, center, central.shiftFromMassCenter(-center, link.mass)};
  }

  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::UniformGravity gravity_;
  std::array<SimTK::MobilizedBody, kLegs> cylinders_, rods_;
  SimTK::MobilizedBody platform_;
  std::array<SimTK::Constraint, 3> balls_;
  SimTK::State state_;
  SimTK::Vector udot_;
};

}  // namespace knee_robot
