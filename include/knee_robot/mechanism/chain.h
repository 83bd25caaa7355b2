#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "knee_robot/mechanism/geometry.h"

namespace knee_robot::mechanism {

/// Radius at which a revolute joint of a chain is counted in metres and newtons. Behind the reader of recordings every
/// actuator, leg or joint, has a position in m and a force in N, so that one set of laws of friction, shapes and
/// thresholds serves all of them; readers and writers convert (Actuator::position_per_m, Actuator::force_per_N).
inline constexpr double kJointRadius_m = 0.1;

/// What a URDF says of one link's inertia, in the frame of the moving body that it belongs to.
struct ChainLink {
  std::string name;
  double mass = 0.0;  ///< kg
  Vector3 center = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();  ///< kg m^2, about the centre of mass
};

/// One moving joint and the body that it moves. The body's frame is the joint's: origin on the axis, turned with it.
struct ChainJoint {
  std::string name;
  bool prismatic = false;
  bool bounded = false;                                      ///< revolute with limits: it does not turn on and on
  Vector3 axis = Vector3::UnitZ();                           ///< unit vector, body's frame
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  ///< body's frame at position 0, in that of the body before
  std::vector<ChainLink> links;  ///< of the body: the joint's child and whatever is fixed to it
};

/// An open chain from base to tip. Fixed and locked joints are folded in: their links belong to the body that carries
/// them.
struct Chain {
  std::vector<ChainJoint> joints;
  Eigen::Isometry3d tip = Eigen::Isometry3d::Identity();  ///< tip link in the last body's frame
  std::string tip_link;

  int size() const { return static_cast<int>(joints.size()); }
};

/// What the URDF says of one moving joint's limits; 0: nothing.
struct ChainLimits {
  double position_min = 0.0, position_max = 0.0;  ///< rad or m; both 0: none
  double velocity_max = 0.0;                      ///< rad/s or m/s
};

/// A joint that the robot file names: it moves, or is locked at a position.
struct NamedJoint {
  std::string name;
  bool locked = false;
  double locked_at = 0.0;  ///< rad or m
};

/// Reads the chain from `base_link` to `tip_link` with urdfdom. Moving are the joints that `named` lists without
/// locking them, all that can move on the way when it is empty; every other joint of the tree is locked, at 0 unless
/// `named` says where. `limits` gets one entry a moving joint. InputError (the URDF, the link or joint, and what to
/// mend) when it is no URDF, not a tree (a link with two parents, a loop), the links are not on one branch, a joint is
/// unknown, of a kind that no chain has, or not on the way, a moving body has no <inertial> or an impossible one, a
/// locked joint mimics a moving one, or there are not 1 to 12 moving joints.
Chain readChain(const std::string& urdf, const std::string& base_link, const std::string& tip_link,
                const std::vector<NamedJoint>& named, std::vector<ChainLimits>& limits);

/// The chain with some of its joints (`lock`, one entry a joint) standing at `position` (rad, m): their bodies belong
/// to those that carry them. At least one joint stays.
Chain lockedAt(const Chain& chain, const std::vector<char>& lock, const Eigen::VectorXd& position);

/// Body frames in the base link's frame at `position` (rad, m; one entry a joint).
std::vector<Eigen::Isometry3d> bodyFrames(const Chain& chain, const Eigen::VectorXd& position);

}  // namespace knee_robot::mechanism
