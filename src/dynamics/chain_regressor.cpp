#include "knee_robot/dynamics/chain_regressor.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "knee_robot/base/errors.h"

namespace knee_robot::dynamics {
namespace {

using mechanism::Matrix3;
using mechanism::Vector3;

/// u^T (tensor x) as a row over [Ixx Ixy Ixz Iyy Iyz Izz].
Eigen::Matrix<double, 1, 6> tensorRow(const Vector3& u, const Vector3& x) {
  Eigen::Matrix<double, 1, 6> row;
  row << u.x() * x.x(), u.x() * x.y() + u.y() * x.x(), u.x() * x.z() + u.z() * x.x(), u.y() * x.y(),
      u.y() * x.z() + u.z() * x.y(), u.z() * x.z();
  return row;
}

/// How a body moves: its own frame's components; the acceleration is less gravity.
struct BodyMotion {
  Vector3 omega = Vector3::Zero(), alpha = Vector3::Zero(), a = Vector3::Zero();
};

/// Virtual power of a body's inertial wrench along the joint that moves the body's origin by `v` and turns it by `w`.
void fillRow(const BodyMotion& m, const Vector3& v, const Vector3& w, Eigen::MatrixXd& regressor, Eigen::Index row,
             Eigen::Index first) {
  auto out = regressor.row(row).segment<kLinkParameters>(first);
  out.head<6>() = tensorRow(w, m.alpha) + tensorRow(w.cross(m.omega), m.omega);
  out.segment<3>(6) =
      (v.cross(m.alpha) + m.omega * m.omega.dot(v) - v * m.omega.squaredNorm() + m.a.cross(w)).transpose();
  out[9] = v.dot(m.a);
}

/// A body whose principal moments break the triangle inequality (URDFs are written with fewer digits than that, or by a
/// fit that did not ask) becomes the nearest possible one: the moments of its mass's second moments, none of which is
/// negative.
LinkInertia nearestPossible(LinkInertia body) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(0.5 * body.inertia.trace() * Matrix3::Identity() - body.inertia);
  const Vector3 second = eigen.eigenvalues().cwiseMax(0.0);
  const Matrix3 moments = eigen.eigenvectors() * second.asDiagonal() * eigen.eigenvectors().transpose();
  body.inertia = moments.trace() * Matrix3::Identity() - moments;
  return body;
}

}  // namespace

std::vector<std::string> impossibleLinks(const mechanism::Chain& chain) {
  std::vector<std::string> names;
  for (const mechanism::ChainJoint& joint : chain.joints) {
    for (const mechanism::ChainLink& link : joint.links) {
      if (link.mass > 0.0 && !inconsistency({link.mass, link.center, link.inertia}).empty()) names.push_back(link.name);
    }
  }
  return names;
}

void chainRegressor(const mechanism::Chain& chain, const Vector3& gravity, const Eigen::VectorXd& position,
                    const Eigen::VectorXd& velocity, const Eigen::VectorXd& acceleration, ChainRegressorData& data) {
  BodyMotion m;
  m.a = -gravity;
  for (int j = 0; j < chain.size(); ++j) {
    const mechanism::ChainJoint& joint = chain.joints[static_cast<std::size_t>(j)];
    const Vector3& axis = joint.axis;
    Matrix3 turn = joint.origin.linear();
    Vector3 shift = joint.origin.translation();
    if (joint.prismatic) {
      shift += turn * axis * position[j];
    } else {
      turn = turn * Eigen::AngleAxisd(position[j], axis).matrix();
    }
    const Matrix3 back = turn.transpose();
    m.a = back * (m.a + m.alpha.cross(shift) + m.omega.cross(m.omega.cross(shift)));
    m.omega = back * m.omega;
    m.alpha = back * m.alpha;
    if (joint.prismatic) {
      m.a += axis * acceleration[j] + 2.0 * velocity[j] * m.omega.cross(axis);
    } else {
      m.alpha += axis * acceleration[j] + velocity[j] * m.omega.cross(axis);
      m.omega += axis * velocity[j];
    }
    for (int i = 0; i < j; ++i) {  // earlier joints, carried into this body's frame and origin
      const std::size_t k = static_cast<std::size_t>(i);
      data.lever[k] = back * (data.lever[k] + data.axis[k].cross(shift));
      data.axis[k] = back * data.axis[k];
    }
    data.lever[static_cast<std::size_t>(j)] = joint.prismatic ? axis : Vector3::Zero();
    data.axis[static_cast<std::size_t>(j)] = joint.prismatic ? Vector3::Zero() : axis;
    for (int i = 0; i <= j; ++i) {
      const std::size_t k = static_cast<std::size_t>(i);
      fillRow(m, data.lever[k], data.axis[k], data.regressor, i, j * kLinkParameters);
    }
  }
}

Eigen::VectorXd chainInertia(const mechanism::Robot& robot) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(robot.chain->size() * kLinkParameters);
  for (int j = 0; j < robot.chain->size(); ++j) {
    for (const mechanism::ChainLink& link : robot.chain->joints[static_cast<std::size_t>(j)].links) {
      if (link.mass == 0.0) continue;  // a frame that was given an empty <inertial>
      LinkInertia body{link.mass, link.center, link.inertia};
      const bool positive = link.mass > 0.0 && principalMoments(body)[0] > -1e-9 * body.inertia.norm();
      if (positive && !inconsistency(body).empty()) body = nearestPossible(body);
      const std::string reason = inconsistency(body);
      if (!reason.empty())
        throw InputError(robot.urdf + ": link " + link.name + " has an impossible inertia: " + reason);
      all.segment<kLinkParameters>(j * kLinkParameters) += toParameters(body);
    }
  }
  return all;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> chainJacobian(const mechanism::Chain& chain, const Eigen::VectorXd& position,
                                                       const Vector3& at) {
  const std::vector<Eigen::Isometry3d> frames = mechanism::bodyFrames(chain, position);
  const Vector3 point = frames.back() * at;
  Eigen::Matrix<double, 6, Eigen::Dynamic> out(6, chain.size());
  for (int i = 0; i < chain.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const Vector3 axis = frames[k].linear() * chain.joints[k].axis;
    const bool slides = chain.joints[k].prismatic;
    out.col(i).head<3>() = slides ? axis : Vector3(axis.cross(point - frames[k].translation()));
    out.col(i).tail<3>() = slides ? Vector3(Vector3::Zero()) : axis;
  }
  return out;
}

std::vector<std::string> chainInertialNames(int joints) {
  std::vector<std::string> names;
  for (int j = 1; j <= joints; ++j) {
    for (const char* name : {"IXX", "IXY", "IXZ", "IYY", "IYZ", "IZZ", "mX", "mY", "mZ", "m"})
      names.push_back(std::string(name) + "_" + std::to_string(j));
  }
  return names;
}

}  // namespace knee_robot::dynamics
