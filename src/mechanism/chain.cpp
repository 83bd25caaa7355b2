#include "knee_robot/mechanism/chain.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/base/words.h"

namespace knee_robot::mechanism {
namespace {

constexpr int kMostJoints = 12;
constexpr double kHeaviest_kg = 1e5, kFarthest_m = 1e3;  ///< beyond it a number is a slip, not a link

/// Keeps urdfdom's complaints for our own sentences: the first, and those about a link's <inertial>, of which urdfdom
/// goes on with what it could read.
class Complaints : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    if (first.empty()) first = text;
    static const std::string kAboutLink = "Could not parse inertial element for Link [";
    if (text.rfind(kAboutLink, 0) == 0)
      inertial[text.substr(kAboutLink.size(), text.rfind(']') - kAboutLink.size())] = last_;
    last_ = text;
  }
  std::string first;
  std::map<std::string, std::string> inertial;  ///< by link

 private:
  std::string last_;
};

bool canMove(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
         joint.type == urdf::Joint::PRISMATIC;
}

Vector3 vectorOf(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Isometry3d transformOf(const urdf::Pose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const urdf::Rotation& r = pose.rotation;
  out.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().matrix();
  out.translation() = vectorOf(pose.position);
  return out;
}

Eigen::Isometry3d moved(bool prismatic, const Vector3& axis, double by) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  if (prismatic) {
    out.translation() = by * axis;
  } else {
    out.linear() = Eigen::AngleAxisd(by, axis).matrix();
  }
  return out;
}

/// Builds a chain out of one URDF; every refusal names it.
class ChainReader {
 public:
  ChainReader(const std::string& path, const std::vector<NamedJoint>& named) : path_(path), named_(named) {
    const std::string text = readFile(path, 64u << 20);
    console_bridge::useOutputHandler(&complaints_);
    model_ = urdf::parseURDF(text);
    console_bridge::restorePreviousOutputHandler();
    if (!model_) refuse("not a URDF of a tree (urdfdom: " + complaints_.first + ")");
    requireTree();
  }

  Chain read(const std::string& base, const std::string& tip, std::vector<ChainLimits>& limits) {
    const std::vector<urdf::JointConstSharedPtr> way = wayTo(base, tip);
    for (const NamedJoint& joint : named_)
      requireOnTheWay(joint, way, base, tip);
    const bool all = std::all_of(named_.begin(), named_.end(), [](const NamedJoint& n) { return n.locked; });
    for (const urdf::JointConstSharedPtr& joint : way) {
      const NamedJoint* named = entry(*joint);
      if (canMove(*joint) && (named != nullptr ? !named->locked : all)) moving_.insert(joint->name);
    }
    Chain chain;
    chain.tip_link = tip;
    limits.clear();
    Eigen::Isometry3d since = Eigen::Isometry3d::Identity();  // from the last moving body to the link reached
    for (const urdf::JointConstSharedPtr& joint : way) {
      since = since * transformOf(joint->parent_to_joint_origin_transform);
      if (moves(*joint)) {
        chain.joints.push_back(jointOf(*joint, since));
        limits.push_back(limitsOf(*joint));
        since.setIdentity();
      } else {
        since = since * lockedPose(*joint);
      }
    }
    chain.tip = since;
    if (chain.size() < 1 || chain.size() > kMostJoints) {
      refuse(std::to_string(chain.size()) + " joints move between " + base + " and " + tip +
             "; a chain has 1 to 12: name the ones that were recorded under `joints`");
    }
    for (const urdf::JointConstSharedPtr& joint : way) {
      if (moves(*joint)) carry(chain, *joint);
    }
    return chain;
  }

 private:
  [[noreturn]] void refuse(const std::string& sentence) const { throw InputError(path_ + ": " + sentence); }

  /// urdfdom silently keeps the last of two parents.
  void requireTree() const {
    std::map<std::string, std::string> joint_above;
    for (const auto& [name, joint] : model_->joints_) {
      const auto [place, is_new] = joint_above.emplace(joint->child_link_name, name);
      if (!is_new) {
        refuse("link " + joint->child_link_name + " hangs on two joints, " + place->second + " and " + name +
               ", which closes a loop; an open chain needs every link on one joint: remove one of the two");
      }
    }
  }

  urdf::LinkConstSharedPtr need(const std::string& name, const char* key) const {
    const urdf::LinkConstSharedPtr link = model_->getLink(name);
    if (!link) refuse("has no link " + name + ", which the robot file names as " + key);
    return link;
  }

  std::vector<urdf::JointConstSharedPtr> wayTo(const std::string& base, const std::string& tip) const {
    need(base, "base_link");
    std::vector<urdf::JointConstSharedPtr> way;
    urdf::LinkConstSharedPtr link = need(tip, "tip_link");
    while (link->name != base) {
      if (!link->parent_joint) {
        refuse("link " + tip + " (tip_link) does not hang on " + base +
               " (base_link): a chain goes from base to tip along one branch");
      }
      way.push_back(link->parent_joint);
      if (way.size() > model_->joints_.size()) refuse("the joints above link " + tip + " form a loop");
      link = model_->getLink(link->parent_joint->parent_link_name);
    }
    std::reverse(way.begin(), way.end());
    return way;
  }

  void requireOnTheWay(const NamedJoint& named, const std::vector<urdf::JointConstSharedPtr>& way,
                       const std::string& base, const std::string& tip) const {
    const urdf::JointConstSharedPtr joint = model_->getJoint(named.name);
    if (!joint) refuse("has no joint " + named.name + ", which the robot file lists under `joints`");
    if (named.locked) return;
    if (std::find(way.begin(), way.end(), joint) == way.end())
      refuse("joint " + named.name + " is not between " + base + " and " + tip +
             "; a joint beside the chain is locked");
    if (!canMove(*joint))
      refuse("joint " + named.name + " is neither revolute, continuous nor prismatic; only those can be recorded");
  }

  const NamedJoint* entry(const urdf::Joint& joint) const {
    const auto found =
        std::find_if(named_.begin(), named_.end(), [&](const NamedJoint& n) { return n.name == joint.name; });
    return found == named_.end() ? nullptr : &*found;
  }

  bool moves(const urdf::Joint& joint) const { return moving_.count(joint.name) > 0; }

  Vector3 axisOf(const urdf::Joint& joint) const {
    const Vector3 axis = vectorOf(joint.axis);
    if (!(axis.norm() > 1e-9)) refuse("joint " + joint.name + " has an axis of length zero");
    return axis.normalized();
  }

  Eigen::Isometry3d lockedPose(const urdf::Joint& joint) const {
    if (joint.type == urdf::Joint::FIXED) return Eigen::Isometry3d::Identity();
    if (!canMove(joint))
      refuse("joint " + joint.name +
             " is floating or planar; only fixed, revolute, continuous and prismatic joints are known");
    const NamedJoint* named = entry(joint);
    return moved(joint.type == urdf::Joint::PRISMATIC, axisOf(joint), named == nullptr ? 0.0 : named->locked_at);
  }

  ChainJoint jointOf(const urdf::Joint& joint, const Eigen::Isometry3d& origin) const {
    if (joint.name.empty() || printable(joint.name) != joint.name)
      refuse("the joint above link " + joint.child_link_name + " is named " + inQuotes(joint.name) +
             ", which no file can say; give it a name");
    ChainJoint out;
    out.name = joint.name;
    out.prismatic = joint.type == urdf::Joint::PRISMATIC;
    out.bounded = joint.type == urdf::Joint::REVOLUTE;
    out.axis = axisOf(joint);
    out.origin = origin;
    return out;
  }

  static ChainLimits limitsOf(const urdf::Joint& joint) {
    ChainLimits limits;
    if (!joint.limits) return limits;
    limits.velocity_max = joint.limits->velocity;
    if (joint.type == urdf::Joint::CONTINUOUS || !(joint.limits->lower < joint.limits->upper)) return limits;
    limits.position_min = joint.limits->lower;
    limits.position_max = joint.limits->upper;
    return limits;
  }

  /// Collects the links that move with a joint's child.
  void carry(Chain& chain, const urdf::Joint& joint) const {
    ChainJoint& body = *std::find_if(chain.joints.begin(), chain.joints.end(),
                                     [&](const ChainJoint& j) { return j.name == joint.name; });
    collect(*model_->getLink(joint.child_link_name), Eigen::Isometry3d::Identity(), body);
    double mass = 0.0;
    for (const ChainLink& link : body.links)
      mass += link.mass;
    if (!(mass > 0.0)) {
      refuse(
          "link " + joint.child_link_name + ", which joint " + joint.name +
          " moves, has no <inertial> with a mass, and nothing fixed to it has one; give its mass, centre and inertia" +
          (complaints_.first.empty() ? "" : " (urdfdom: " + complaints_.first + ")"));
    }
  }

  void requireSane(const ChainLink& link) const {
    const bool mass = link.mass >= 0.0 && link.mass <= kHeaviest_kg;
    const bool center = link.center.allFinite() && link.center.norm() <= kFarthest_m;
    const bool inertia = link.inertia.allFinite() && link.inertia.norm() <= kHeaviest_kg * kFarthest_m;
    if (mass && center && inertia) return;
    refuse("link " + link.name + ": its <inertial> has a " +
           (!mass     ? "mass"
            : !center ? "centre"
                      : "moment") +
           " that no link has (a mass is 0 to 1e5 kg, a centre within 1000 m); correct it");
  }

  /// A locked joint that follows a moving one is not locked, and what both carry does not move as a chain does.
  void requireNoFollower(const urdf::Joint& joint) const {
    if (!joint.mimic || entry(joint) != nullptr || moving_.count(joint.mimic->joint_name) == 0) return;
    refuse("joint " + joint.name + " follows joint " + joint.mimic->joint_name +
           " (<mimic>), which moves, so that it is not locked; list it under `joints`: with its own columns if it has "
           "a drive, with locked_at_rad (prismatic: locked_at_m) if what it moves may be neglected");
  }

  void collect(const urdf::Link& link, const Eigen::Isometry3d& at, ChainJoint& body) const {
    if (const auto bad = complaints_.inertial.find(link.name); bad != complaints_.inertial.end())
      refuse("link " + link.name + ": its <inertial> cannot be read (" + bad->second + "); give finite numbers");
    if (link.inertial) {
      const urdf::Inertial& given = *link.inertial;
      const Eigen::Isometry3d frame = at * transformOf(given.origin);
      ChainLink out;
      out.name = link.name;
      out.mass = given.mass;
      out.center = frame.translation();
      Matrix3 tensor;
      tensor << given.ixx, given.ixy, given.ixz, given.ixy, given.iyy, given.iyz, given.ixz, given.iyz, given.izz;
      out.inertia = frame.linear() * tensor * frame.linear().transpose();
      requireSane(out);
      body.links.push_back(out);
    }
    for (const urdf::JointSharedPtr& joint : link.child_joints) {
      if (moves(*joint)) continue;
      requireNoFollower(*joint);
      const Eigen::Isometry3d child = at * transformOf(joint->parent_to_joint_origin_transform) * lockedPose(*joint);
      collect(*model_->getLink(joint->child_link_name), child, body);
    }
  }

  std::string path_;
  Complaints complaints_;
  const std::vector<NamedJoint>& named_;
  urdf::ModelInterfaceSharedPtr model_;
  std::set<std::string> moving_;
};

}  // namespace

Chain readChain(const std::string& urdf, const std::string& base_link, const std::string& tip_link,
                const std::vector<NamedJoint>& named, std::vector<ChainLimits>& limits) {
  return ChainReader(urdf, named).read(base_link, tip_link, limits);
}

Chain lockedAt(const Chain& chain, const std::vector<char>& lock, const Eigen::VectorXd& position) {
  Chain out;
  out.tip_link = chain.tip_link;
  Eigen::Isometry3d since = Eigen::Isometry3d::Identity();  // from the last joint that moves to the body reached
  for (int i = 0; i < chain.size(); ++i) {
    ChainJoint joint = chain.joints[static_cast<std::size_t>(i)];
    if (!lock[static_cast<std::size_t>(i)]) {
      joint.origin = since * joint.origin;
      since.setIdentity();
      out.joints.push_back(joint);
      continue;
    }
    since = since * joint.origin * moved(joint.prismatic, joint.axis, position[i]);
    if (out.joints.empty()) continue;  // stands with the base
    for (ChainLink link : joint.links) {
      link.center = since * link.center;
      link.inertia = since.linear() * link.inertia * since.linear().transpose();
      out.joints.back().links.push_back(link);
    }
  }
  out.tip = since * chain.tip;
  return out;
}

std::vector<Eigen::Isometry3d> bodyFrames(const Chain& chain, const Eigen::VectorXd& position) {
  std::vector<Eigen::Isometry3d> frames;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (int i = 0; i < chain.size(); ++i) {
    const ChainJoint& joint = chain.joints[static_cast<std::size_t>(i)];
    frame = frame * joint.origin * moved(joint.prismatic, joint.axis, position[i]);
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace knee_robot::mechanism
