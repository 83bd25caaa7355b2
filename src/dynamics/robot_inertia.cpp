#include "knee_robot/dynamics/robot_inertia.h"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::dynamics {
namespace {

constexpr double kGeometryTolerance =
    1e-6;  // m; docs/contract.md, section 2. Also used for axes and rotations (1 m lever).

/// urdfdom without its own messages on standard error: the refusal says in one line what is wrong.
urdf::ModelInterfaceSharedPtr parseQuietly(const std::string& path) {
  const std::string text = readFile(path, 64u << 20);
  console_bridge::noOutputHandler();
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  console_bridge::restorePreviousOutputHandler();
  return model;
}

/// Reads one URDF; every refusal names it.
class UrdfReader {
 public:
  explicit UrdfReader(const std::string& path) : path_(path), model_(parseQuietly(path)) {
    if (!model_) throw InputError(path_ + ": not a URDF (urdfdom could not read it)");
  }

  [[noreturn]] void refuse(const std::string& sentence) const { throw InputError(path_ + ": " + sentence); }

  LinkInertia inertiaOf(const std::string& name) const {
    const urdf::LinkConstSharedPtr link = model_->getLink(name);
    if (!link) refuse("link " + name + " is missing");
    if (!link->inertial) refuse("link " + name + " has no <inertial>");
    const urdf::Inertial& given = *link->inertial;
    const mechanism::Matrix3 turn = rotationOf(given.origin.rotation);
    LinkInertia inertia;
    inertia.mass = given.mass;
    inertia.center = mechanism::Vector3(given.origin.position.x, given.origin.position.y, given.origin.position.z);
    mechanism::Matrix3 tensor;
    tensor << given.ixx, given.ixy, given.ixz, given.ixy, given.iyy, given.iyz, given.ixz, given.iyz, given.izz;
    inertia.inertia = turn * tensor * turn.transpose();
    const std::string reason = inconsistency(inertia);
    if (!reason.empty()) refuse("link " + name + " has an impossible inertia: " + reason);
    return inertia;
  }

  /// Checks that joint `name` connects these links, is of this type and axis, and sits where the geometry says.
  void checkJoint(const std::string& name, const std::string& parent, const std::string& child, int type,
                  const mechanism::Vector3& axis, const mechanism::Vector3& position,
                  const mechanism::Matrix3& rotation) const {
    const urdf::JointConstSharedPtr joint = model_->getJoint(name);
    if (!joint) refuse("joint " + name + " is missing");
    if (joint->parent_link_name != parent || joint->child_link_name != child) {
      refuse("joint " + name + " must connect " + parent + " to " + child);
    }
    if (joint->type != type && !(type == urdf::Joint::REVOLUTE && joint->type == urdf::Joint::CONTINUOUS)) {
      refuse("joint " + name + " has the wrong type");
    }
    const urdf::Pose& at = joint->parent_to_joint_origin_transform;
    const double shift = (mechanism::Vector3(at.position.x, at.position.y, at.position.z) - position).norm();
    if (!(shift <= kGeometryTolerance)) {
      refuse("joint " + name + " is " + shortNumber(shift) +
             " m from where the robot file's geometry puts it (limit 1e-6 m); write the URDF anew with "
             "scripts/write_urdf");
    }
    if (!((rotationOf(at.rotation) - rotation).norm() <= kGeometryTolerance)) refuse("joint " + name + " is turned");
    const mechanism::Vector3 given(joint->axis.x, joint->axis.y, joint->axis.z);
    if (type != urdf::Joint::FIXED && !((given.normalized() - axis).norm() <= kGeometryTolerance)) {
      refuse("joint " + name + " has the wrong axis");
    }
  }

 private:
  static mechanism::Matrix3 rotationOf(const urdf::Rotation& r) {
    return Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().matrix();
  }

  std::string path_;
  urdf::ModelInterfaceSharedPtr model_;
};

mechanism::Matrix3 columns(const mechanism::Vector3& x, const mechanism::Vector3& y, const mechanism::Vector3& z) {
  mechanism::Matrix3 matrix;
  matrix << x, y, z;
  return matrix;
}

/// The joints between the frames of parameters.h, all joint values zero (then every leg lies along the base's X).
void checkGeometry(const UrdfReader& urdf, const mechanism::Mechanism& mechanism) {
  const mechanism::Vector3 ex = mechanism::Vector3::UnitX(), ey = mechanism::Vector3::UnitY(),
                           ez = mechanism::Vector3::UnitZ(), none = mechanism::Vector3::Zero();
  const mechanism::Matrix3 same = mechanism::Matrix3::Identity();
  const mechanism::Matrix3 rod_in_cylinder = columns(ex, -ez, ey);
  for (int i = 0; i < 3; ++i) {
    const std::string k = std::to_string(i + 1), leg = "leg_" + k + "_";
    urdf.checkJoint("q" + k + "1", "base", leg + "cross", urdf::Joint::REVOLUTE, -ey, mechanism.base_points[i], same);
    urdf.checkJoint("q" + k + "2", leg + "cross", leg + "cylinder", urdf::Joint::REVOLUTE, ez, none,
                    columns(-ey, ex, ez));
    urdf.checkJoint("q" + k + "3", leg + "cylinder", leg + "rod", urdf::Joint::PRISMATIC, ez, none, rod_in_cylinder);
    urdf.checkJoint("platform_joint_" + k, "platform", "platform_point_" + k, urdf::Joint::FIXED, ez,
                    mechanism.platform_points[i], same);
  }
  urdf.checkJoint("q41", "base", "leg_4_cylinder", urdf::Joint::REVOLUTE, ez, mechanism.base_points[3],
                  columns(-ez, ex, -ey));
  urdf.checkJoint("q42", "leg_4_cylinder", "leg_4_rod", urdf::Joint::PRISMATIC, ez, none, rod_in_cylinder);
  urdf.checkJoint("theta_4", "leg_4_rod", "leg_4_cross", urdf::Joint::REVOLUTE, ey, none, same);
  urdf.checkJoint("psi_4", "leg_4_cross", "platform", urdf::Joint::REVOLUTE, ez, none, same);
}

}  // namespace

RobotInertia loadRobotInertia(const mechanism::Robot& robot) {
  if (!robot.mechanism) throw InputError(robot.path + ": a bench of axes has no link inertias");
  if (robot.urdf.empty()) throw InputError(robot.path + ": the key urdf is missing; link inertias come from a URDF");
  const UrdfReader urdf(robot.urdf);
  RobotInertia result;
  for (int k = 0; k < kLinks; ++k)
    result.links[k] = urdf.inertiaOf(linkNames()[k]);
  checkGeometry(urdf, *robot.mechanism);
  return result;
}

InertialParameters toParameters(const RobotInertia& inertia) {
  InertialParameters all;
  for (int k = 0; k < kLinks; ++k)
    all.segment<kLinkParameters>(kLinkParameters * k) = toParameters(inertia.links[k]);
  return all;
}

}  // namespace knee_robot::dynamics
